function result = compute(command, flags, scene, given)
%COMPUTE  Runs a command that writes the results of a scene, and reads them; `flags` are its switches besides 'quiet'.
[options, overrides] = nlmodes.internal.options(given, [{'out'}, flags, {'quiet'}]);
[file, directory, overrides, done] = nlmodes.internal.scene_file(scene, options.out, overrides); %#ok<ASGLU>
call = [command, {file}, nlmodes.internal.set_options(overrides)];
if ~isempty(directory)
  call = [call, {'--out', directory}];
end
wanted = @(name) ~isempty(options.(name)) && options.(name);
call = [call, strcat('--', flags(cellfun(wanted, flags)))];
[status, text] = nlmodes.internal.call(call, ~wanted('quiet'));
written = nlmodes.internal.directory_of(text);
if status == 2
  error('nlmodes:scene', '%s', nlmodes.internal.messages(text));
elseif isempty(written)
  error('nlmodes:run', '%s', strtrim(text));
end
nlmodes.internal.warn(text);
result = nlmodes.read(written);
end
