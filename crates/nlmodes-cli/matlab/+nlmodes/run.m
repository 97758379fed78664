function result = run(scene, varargin)
%NLMODES.RUN  Compute what a scene describes, and read the results.
%
%   result = nlmodes.run('configs/rod.toml')
%   result = nlmodes.run(scene)                            a structure with the tables of a scene
%   result = nlmodes.run(scene, 'method.harmonics', 7)     replaces a value of the scene, as --set does
%   result = nlmodes.run(scene, 'out', 'results/my_rod')   directory of the files
%
% Further options, each with true or false: 'resume' continues an interrupted run of the same scene, 'force' overwrites
% the results of another one, 'certify' estimates the errors at more points, 'quiet' prints nothing. Stops are numbered
% from 0 in keys: 'contact.0.gap_m'.
%
% While it runs, what the command line prints is shown: progress, and at the end peaks, jumps and estimated errors.
%
% A scene is a TOML file, or a structure with the same tables: scene.structure.length_m = 1. Tables that may occur
% several times, such as contact, force or response, are structure arrays or cell arrays. Paths in a structure, and
% those that replace them, are relative to the current folder; in a file they are relative to the file.
%
% The files are written to 'out', else to the directory that the scene names; those of a structure that names none are
% in a temporary directory until MATLAB ends. For the fields of the result see nlmodes.read.
%
% Errors: nlmodes:scene where scene or call are wrong, with the text of the command line, which names key, value and
% what was expected; nlmodes:run where there are no results. A branch that ends early is no error: see result.complete
% and result.ended_because. Reservations about the results are warnings (nlmodes:warning), also with 'quiet'.
result = nlmodes.internal.compute({'run'}, {'resume', 'force', 'certify'}, scene, varargin);
end
