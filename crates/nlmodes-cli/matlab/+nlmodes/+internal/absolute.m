function path = absolute(path)
%ABSOLUTE  A path from the root.
path = char(path);
if isempty(regexp(path, '^([/\\]|[A-Za-z]:)', 'once'))
  path = fullfile(pwd, path);
end
end
