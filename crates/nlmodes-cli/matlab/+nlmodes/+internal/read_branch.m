function branch = read_branch(root, place, name, arrays)
%READ_BRANCH  The tables, and if wanted the arrays, of one branch in a directory.
folder = fullfile(root, place);
branch = struct('name', name, 'folder', folder, 'summary', nlmodes.internal.json(folder));
branch.branch = nlmodes.internal.csv(fullfile(folder, 'branch.csv'));
for table = {'contacts', 'participation'}
  file = fullfile(folder, [table{1}, '.csv']);
  branch.(table{1}) = nlmodes.internal.optional(@nlmodes.internal.csv, file, true);
end
for archive = {'harmonics', 'histories'}
  file = fullfile(folder, [archive{1}, '.npz']);
  branch.(archive{1}) = nlmodes.internal.optional(@nlmodes.internal.npz, file, arrays);
end
end
