function [places, names] = places_of(folder, summary)
%PLACES_OF  Relative paths and names of the branches in a directory: in the order of its summary, else in that of their
% names.
places = nlmodes.internal.folders_with(folder, 'branch.csv');
names = strrep(places, filesep, '/');
if ~isfield(summary, 'branches') || ~all(isfield(summary.branches, {'directory', 'label'})), return; end
told = cellfun(@(place) strrep(place, '/', filesep), {summary.branches.directory}, 'UniformOutput', false);
for k = numel(told):-1:1
  at = strcmp(places, told{k});
  names(at) = {summary.branches(k).label};
  order = [find(at), find(~at)];
  [places, names] = deal(places(order), names(order));
end
end
