function [status, text] = call(words, shown)
%CALL  Runs the command line; its exit status, and all that it prints.
%
% With `shown` its lines are printed as they come (in Octave on Windows at the end). Octave leaves out warnings and
% errors, which are raised later; MATLAB can only show all.
line = strjoin(cellfun(@quoted, [{nlmodes.program()}, words], 'UniformOutput', false), ' ');
if ispc, line = ['"', line, '"']; end
line = [line, ' 2>&1'];
octave = exist('OCTAVE_VERSION', 'builtin') ~= 0;
if shown && octave && ~ispc
  [status, text] = streamed(line);
elseif shown && ~octave
  [status, text] = system(line, '-echo');
else
  [status, text] = system(line);
  if shown, told(strsplit(text, char(10)), false); end
end
if any(status == [126, 127, 9009])
  error('nlmodes:run', ['%s cannot be run: %s\nInstall it, or say where it is: ', ...
    'nlmodes.program(''/path/to/nlmodes-cli''), or the environment variable NLMODES_CLI'], ...
    nlmodes.program(), strtrim(text));
end
end

function [status, text] = streamed(line)
% Octave's pclose does not give the exit status: the shell prints it behind everything else. Its fgetl waits for the
% line behind the one that it gives, therefore byte by byte.
mark = 'exit status of nlmodes-cli: ';
in = popen([line, '; echo "', mark, '$?"'], 'r');
done = onCleanup(@() pclose(in));
[lines, own, held, status] = deal(cell(1, 0), '', false, 1);
next = fread(in, 1, 'uint8=>char');
while ~isempty(next)
  if next ~= char(10)
    own(end + 1) = next; %#ok<AGROW>
  elseif strncmp(own, mark, numel(mark))
    status = str2double(own(numel(mark) + 1:end));
  else
    held = told({own}, held);
    lines{end + 1} = [own, char(10)]; %#ok<AGROW>
  end
  if next == char(10), own = ''; end
  next = fread(in, 1, 'uint8=>char');
end
text = [lines{:}];
end

function held = told(lines, held)
% Prints lines that are neither part of a warning nor of an error.
for k = 1:numel(lines)
  begins = ~isempty(regexp(lines{k}, '^(warning|error|sh): |^\d+ errors? in ', 'once'));
  belongs = held && (isempty(lines{k}) || ~isempty(regexp(lines{k}, '^(\s|\d+ +\|)', 'once')));
  held = begins || belongs;
  if ~held, fprintf('%s\n', lines{k}); end
end
fflush(stdout);
end

function text = quoted(word)
if ispc
  text = ['"', strrep(word, '"', '\"'), '"'];
else
  text = ['''', strrep(word, '''', '''\'''''), ''''];
end
end
