function branch = read_branch(root, place, name, arrays)
%READ_BRANCH  The tables, and if wanted the arrays, of one branch in a directory.
folder = fullfile(root, place);
branch = struct('name', name, 'folder', folder, 'summary', nlmodes.internal.json(folder));
branch.branch = nlmodes.internal.csv(fullfile(folder, 'branch.csv'));
for table = {'contacts', 'participation'}
  branch.(table{1}) = optional(@nlmodes.internal.csv, fullfile(folder, [table{1}, '.csv']), true);
end
for archive = {'harmonics', 'histories'}
  branch.(archive{1}) = optional(@nlmodes.internal.npz, fullfile(folder, [archive{1}, '.npz']), arrays);
end
end

function value = optional(reader, file, wanted)
value = [];
if wanted && isfile(file), value = reader(file); end
end
