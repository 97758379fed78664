function [file, directory, done] = scene_file(scene, out)
%SCENE_FILE  The file of a scene, the directory of its results ('' where the scene names it), and what deletes a
% temporary file.
done = [];
directory = '';
if ~isempty(out), directory = nlmodes.internal.absolute(char(out)); end
if ischar(scene) || isa(scene, 'string')
  file = char(scene);
  return
elseif ~(isstruct(scene) && isscalar(scene))
  error('nlmodes:scene', 'scene is a %s; the path of a TOML file or a structure was expected', class(scene));
end
folder = tempname;
mkdir(folder);
file = fullfile(folder, 'scene.toml');
out = nlmodes.internal.open(file, 'w');
fprintf(out, '%s', nlmodes.internal.toml(nlmodes.internal.with_absolute_paths(scene)));
fclose(out);
if isempty(directory)
  directory = fullfile(folder, 'results');
  if isfield(scene, 'output') && isfield(scene.output, 'directory')
    directory = nlmodes.internal.absolute(scene.output.directory);
  end
end
done = onCleanup(@() delete(file));
end
