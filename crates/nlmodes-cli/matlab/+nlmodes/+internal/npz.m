function arrays = npz(file)
%NPZ  An archive of NumPy as a structure with a field for each array.
%
% One-dimensional arrays are column vectors, others keep the order of their dimensions; whole numbers become doubles,
% texts cell arrays.
folder = tempname;
mkdir(folder);
done = onCleanup(@() remove(folder));
unzip(file, folder);
entries = dir(fullfile(folder, '*.npy'));
arrays = struct();
for k = 1:numel(entries)
  [~, name] = fileparts(entries(k).name);
  arrays.(name) = nlmodes.internal.npy(fullfile(folder, entries(k).name));
end
end

function remove(folder)
entries = dir(fullfile(folder, '*.npy'));
for k = 1:numel(entries), delete(fullfile(folder, entries(k).name)); end
rmdir(folder);
end
