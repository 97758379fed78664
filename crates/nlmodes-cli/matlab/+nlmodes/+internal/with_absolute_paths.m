function value = with_absolute_paths(value, key)
%WITH_ABSOLUTE_PATHS  The same scene, in which paths from the current folder are paths from the root.
%
% Texts under keys that hold nothing but paths are such, whether or not there is something yet, and texts that name a
% file. A part of a file follows a hash: model.mat#K. `key` is that of a single value, dotted.
if nargin < 2, key = ''; end
if isstruct(value)
  for name = fieldnames(value)'
    for k = 1:numel(value)
      value(k).(name{1}) = nlmodes.internal.with_absolute_paths(value(k).(name{1}), name{1});
    end
  end
elseif iscell(value)
  value = cellfun(@(one) nlmodes.internal.with_absolute_paths(one, key), value, 'UniformOutput', false);
elseif isa(value, 'string') && ~isscalar(value)
  value = nlmodes.internal.with_absolute_paths(cellstr(value), key);
elseif (ischar(value) && size(value, 1) == 1) || isa(value, 'string')
  parts = strsplit(char(value), '#');
  paths = {'damper_table', 'dofs', 'entries', 'files', 'mass', 'mesh', 'pairs', 'path', 'results', 'stiffness', ...
    'table'};
  is_path = any(strcmp(regexprep(key, '^.*\.', ''), paths)) && ~isempty(parts{1});
  if is_path || (any(parts{1} == '.') && isfile(parts{1}))
    parts{1} = nlmodes.internal.absolute(parts{1});
    value = strjoin(parts, '#');
  end
end
end
