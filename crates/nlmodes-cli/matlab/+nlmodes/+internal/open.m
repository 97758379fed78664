function file = open(path, mode)
%OPEN  A file that can be read or written, or an error that says why not.
[file, why] = fopen(path, mode);
if file < 0
  error('nlmodes:run', '%s: %s', path, why);
end
end
