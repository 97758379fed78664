function found = folders_with(folder, name)
%FOLDERS_WITH  Relative paths of a folder ('') and those below it that have a file of this name, in the order of their
% names.
found = cell(1, 0);
if isfile(fullfile(folder, name)), found = {''}; end
entries = dir(folder);
entries = entries([entries.isdir] & ~ismember({entries.name}, {'.', '..'}));
for own = sort({entries.name})
  below = nlmodes.internal.folders_with(fullfile(folder, own{1}), name);
  found = [found, cellfun(@(one) fullfile(own{1}, one), below, 'UniformOutput', false)]; %#ok<AGROW>
end
end
