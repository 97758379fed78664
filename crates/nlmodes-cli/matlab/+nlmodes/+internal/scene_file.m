function [file, directory, overrides, done] = scene_file(scene, out, overrides)
%SCENE_FILE  The file of a scene, the directory of its results ('' where the scene names it), the {key, value} rows that
% replace values of it, and what deletes a temporary file.
done = [];
directory = '';
if ~isempty(out), directory = nlmodes.internal.absolute(char(out)); end
if ischar(scene) || isa(scene, 'string')
  file = char(scene);
  return
elseif ~(isstruct(scene) && isscalar(scene))
  error('nlmodes:scene', 'scene is a %s; the path of a TOML file or a structure was expected', class(scene));
end
folder = nlmodes.internal.temporary();
file = fullfile(folder, 'scene.toml');
written = nlmodes.internal.open(file, 'w');
fprintf(written, '%s', nlmodes.internal.toml(nlmodes.internal.with_absolute_paths(scene)));
fclose(written);
for k = 1:size(overrides, 1)
  overrides{k, 2} = nlmodes.internal.with_absolute_paths(overrides{k, 2}, overrides{k, 1});
end
if isempty(directory)
  directory = fullfile(folder, 'results');
  if isfield(scene, 'output') && isfield(scene.output, 'directory')
    directory = nlmodes.internal.absolute(scene.output.directory);
  end
end
done = onCleanup(@() delete(file));
end
