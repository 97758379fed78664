function warn(said)
%WARN  Issues what the command line prints of warnings and reservations as warnings, each with the lines that show its
% place.
lines = strsplit(said, char(10));
head = '';
for k = 1:numel(lines)
  own = lines{k};
  if ~isempty(regexp(own, '^(warning|error): ', 'once'))
    last = k;
    while last < numel(lines) && ~isempty(regexp(lines{last + 1}, '^(\s+\S|\d+ +\|)', 'once'))
      last = last + 1;
    end
    raise(regexprep(strjoin(lines(k:last), char(10)), '^\w+: ', ''));
    continue
  end
  about = '';
  further = regexp(own, '^ +(.+: )\d+ points; ', 'tokens', 'once');
  if ~isempty(further)
    about = further{1};
  elseif isempty(regexp(own, '^\S', 'once'))
    about = head;
  else
    head = named(own);
  end
  for text = reservations(own)
    raise([about, text{1}]);
  end
end
end

function raise(text)
warning('nlmodes:warning', '%s', strtrim(text));
end

function texts = reservations(line)
% Parts of a line of results that say what is not known of them.
patterns = {'^ +(stability is known at .*)$', '; (the stability of .* was left out, its time was used up)', ...
  '^ +(finding \S+: .*)$', '; (no motion with twice as many was found [^;]*)'};
texts = cellfun(@(pattern) regexp(line, pattern, 'tokens', 'once'), patterns, 'UniformOutput', false);
texts = [texts{:}];
end

function head = named(line)
% What the lines below are about: a level, a record, a curve.
found = regexp(line, '^curve \d+ of \d+: (.*)$', 'tokens', 'once');
if isempty(found), found = regexp(line, '^(?!Results in |part )([^:]*):(?: .*)?$', 'tokens', 'once'); end
head = '';
if ~isempty(found), head = [found{1}, ': ']; end
end
