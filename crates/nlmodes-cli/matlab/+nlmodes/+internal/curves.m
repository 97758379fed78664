function curves = curves(result)
%CURVES  What a result has for figures: a name, columns, and whether they are points of a test.
%
% Curves of responses are parts of one table; levels in their names have four digits, as long as these tell them apart.
curves = struct('name', {}, 'columns', {}, 'is_test', {});
for k = 1:numel(result.branches)
  columns = result.branches(k).branch;
  if ~isfield(columns, 'curve')
    curves(end + 1) = one(result.branches(k).name, 'branch', columns, false); %#ok<AGROW>
    continue
  end
  for number = unique(columns.curve)'
    own = structfun(@(column) column(columns.curve == number), columns, 'UniformOutput', false);
    curves(end + 1) = one(own.name{1}, 'curve', own, false); %#ok<AGROW>
  end
end
names = cellfun(@short, {curves.name}, 'UniformOutput', false);
if numel(unique(names)) == numel(unique({curves.name})), [curves.name] = names{:}; end
if isempty(curves) && isfield(result, 'points') && ~isempty(result.points)
  title = '';
  if isfield(result.summary, 'title'), title = result.summary.title; end
  curves = one(title, 'test', result.points, true);
end
end

function curve = one(name, default, columns, is_test)
if isempty(name), name = default; end
curve = struct('name', name, 'columns', columns, 'is_test', is_test);
end

function name = short(name)
found = regexp(name, '^(\d+\.?\d*(?:e[-+]?\d+)?)( .*)$', 'tokens', 'once');
if ~isempty(found), name = [sprintf('%.4g', str2double(found{1})), found{2}]; end
end
