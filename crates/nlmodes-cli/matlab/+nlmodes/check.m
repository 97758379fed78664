function text = check(scene, varargin)
%NLMODES.CHECK  Read and check a scene: is it valid, and what would be computed?
%
%   nlmodes.check(scene)                                   prints it
%   text = nlmodes.check(scene, 'contact.0.gap_m', 1e-3)   returns it
%
% Computes no more than linear modes, and writes nothing. Raises nlmodes:scene with the text of the command line where a
% run would not begin.
[~, overrides] = nlmodes.internal.options(varargin, {});
[file, ~, overrides, done] = nlmodes.internal.scene_file(scene, [], overrides); %#ok<ASGLU> deleted with `done`
[status, said] = nlmodes.internal.call([{'check', file}, nlmodes.internal.set_options(overrides)], false);
if status ~= 0
  error('nlmodes:scene', '%s', nlmodes.internal.messages(said));
end
if nargout > 0
  text = said;
else
  fprintf('%s', said);
end
end
