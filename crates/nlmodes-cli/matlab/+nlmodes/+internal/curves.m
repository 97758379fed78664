function curves = curves(result)
%CURVES  The curves of a result for figures: a name and columns each; those of responses are parts of one table.
curves = struct('name', {}, 'columns', {});
for k = 1:numel(result.branches)
  columns = result.branches(k).branch;
  if ~isfield(columns, 'curve')
    curves(end + 1) = struct('name', name_of(result.branches(k)), 'columns', columns); %#ok<AGROW>
    continue
  end
  for number = unique(columns.curve)'
    own = structfun(@(column) column(columns.curve == number), columns, 'UniformOutput', false);
    curves(end + 1) = struct('name', own.name{1}, 'columns', own); %#ok<AGROW>
  end
end
end

function name = name_of(branch)
name = branch.name;
if isempty(name), name = 'branch'; end
end
