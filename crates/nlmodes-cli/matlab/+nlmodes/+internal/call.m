function [status, text] = call(words)
%CALL  Runs the command line; its exit status, and all that it prints.
line = strjoin(cellfun(@quoted, [{nlmodes.program()}, words], 'UniformOutput', false), ' ');
if ispc, line = ['"', line, '"']; end
[status, text] = system([line, ' 2>&1']);
if any(status == [126, 127, 9009])
  error('nlmodes:run', ['%s cannot be run: %s\nInstall it, or say where it is: ', ...
    'nlmodes.program(''/path/to/nlmodes-cli''), or the environment variable NLMODES_CLI'], ...
    nlmodes.program(), strtrim(text));
end
end

function text = quoted(word)
if ispc
  text = ['"', strrep(word, '"', '\"'), '"'];
else
  text = ['''', strrep(word, '''', '''\'''''), ''''];
end
end
