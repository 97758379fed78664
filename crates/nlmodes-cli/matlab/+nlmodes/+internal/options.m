function [options, rest] = options(given, names)
%OPTIONS  Options of a call by name: a field for each of `names` ([] where it is not given), and the rest as {key,
% value} rows.
%
% The rest are keys of a scene, which have a dot or are tables (structures); another name is an error that lists the
% options.
options = cell2struct(cell(1, numel(names)), names, 2);
rest = cell(0, 2);
if mod(numel(given), 2) ~= 0
  error('nlmodes:scene', 'options are pairs of a name and a value; the last one has no value');
end
for k = 1:2:numel(given)
  name = char(given{k});
  if any(strcmp(name, names))
    options.(name) = given{k + 1};
  elseif any(name == '.')
    rest(end + 1, :) = {name, given{k + 1}}; %#ok<AGROW>
  else
    error('nlmodes:scene', ...
      'unknown option `%s`: expected %s or a key of the scene with its table, as method.harmonics', ...
      name, strjoin(names, ', '));
  end
end
end
