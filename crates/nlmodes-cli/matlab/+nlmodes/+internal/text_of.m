function text = text_of(file)
%TEXT_OF  All of a file of UTF-8 as text.
in = nlmodes.internal.open(file, 'r');
done = onCleanup(@() fclose(in));
bytes = fread(in, Inf, 'uint8=>uint8')';
if exist('OCTAVE_VERSION', 'builtin')
  text = char(bytes);
else
  text = native2unicode(bytes, 'UTF-8');
end
end
