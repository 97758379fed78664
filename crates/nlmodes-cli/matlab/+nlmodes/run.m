function result = run(scene, varargin)
%NLMODES.RUN  Compute what a scene describes, and read the results.
%
%   result = nlmodes.run('configs/rod.toml')
%   result = nlmodes.run(scene)                            a structure with the tables of a scene
%   result = nlmodes.run(scene, 'method.harmonics', 7)     replaces a value of the scene, as --set does
%   result = nlmodes.run(scene, 'out', 'results/my_rod')   directory of the files
%
% Further options, each with true or false: 'resume' continues an interrupted run of the same scene, 'force' overwrites
% the results of another one, 'certify' estimates the errors at more points. Stops are numbered from 0 in keys:
% 'contact.0.gap_m'.
%
% A scene is a TOML file, or a structure with the same tables: scene.structure.length_m = 1. Tables that may occur
% several times, such as contact, force or response, are structure arrays or cell arrays. Paths in a structure are
% relative to the current folder.
%
% The files are written to 'out', else to the directory that the scene names; those of a structure that names none are
% in a temporary directory until MATLAB ends. For the fields of the result see nlmodes.read.
%
% Errors: nlmodes:scene where scene or call are wrong, with the text of the command line, which names key, value and
% what was expected; nlmodes:run where there are no results. A branch that ends early is no error: see result.complete
% and result.ended_because. Reservations about the results are warnings (nlmodes:warning).
[options, overrides] = nlmodes.internal.options(varargin, {'out', 'resume', 'force', 'certify'});
[file, directory, done] = nlmodes.internal.scene_file(scene, options.out); %#ok<ASGLU> the scene is deleted with `done`
call = [{'run', file}, nlmodes.internal.set_options(overrides)];
if ~isempty(directory)
  call = [call, {'--out', directory}];
end
for flag = {'resume', 'force', 'certify'}
  if ~isempty(options.(flag{1})) && options.(flag{1})
    call{end + 1} = ['--', flag{1}]; %#ok<AGROW>
  end
end
[status, text] = nlmodes.internal.call(call);
written = nlmodes.internal.directory_of(text);
if status == 2
  error('nlmodes:scene', '%s', nlmodes.internal.messages(text));
elseif isempty(written)
  error('nlmodes:run', '%s', strtrim(text));
end
nlmodes.internal.warn(text);
result = nlmodes.read(written);
end
