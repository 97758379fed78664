function warn(said)
%WARN  Issues the warnings of the command line as those of MATLAB, each with the lines that show its place.
lines = strsplit(said, char(10));
at = find(strncmp(lines, 'warning: ', 9));
for k = at
  last = k;
  while last < numel(lines) && ~isempty(regexp(lines{last + 1}, '^(\s+\S|\d+ +\|)', 'once'))
    last = last + 1;
  end
  text = strtrim(strjoin(lines(k:last), char(10)));
  warning('nlmodes:warning', '%s', text(10:end));
end
end
