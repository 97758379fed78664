function value = with_absolute_paths(value)
%WITH_ABSOLUTE_PATHS  The same scene, in which texts that name a file from the current folder name it from anywhere.
%
% A part of a file follows a hash: model.mat#K.
if isstruct(value)
  for name = fieldnames(value)'
    for k = 1:numel(value)
      value(k).(name{1}) = nlmodes.internal.with_absolute_paths(value(k).(name{1}));
    end
  end
elseif iscell(value)
  value = cellfun(@nlmodes.internal.with_absolute_paths, value, 'UniformOutput', false);
elseif ischar(value) && any(value == '.')
  parts = strsplit(value, '#');
  if isfile(parts{1})
    parts{1} = nlmodes.internal.absolute(parts{1});
    value = strjoin(parts, '#');
  end
end
end
