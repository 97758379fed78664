function result = extract(scene, varargin)
%NLMODES.EXTRACT  Points of a nonlinear mode from the measured records that a scene describes.
%
%   test = nlmodes.extract('rig.toml')
%   test = nlmodes.extract(scene, 'out', 'results/test')   a structure with the tables of a scene
%   nlmodes.plot(test)                                     backbone: frequency over amplitude, with its errors
%   nlmodes.plot(computed, 'over', test)                   over a computed curve
%
% test.points has the columns of modal_points.csv, a row for each record or level, with a column ..._uncertainty beside
% most. Options are those of nlmodes.run without 'resume' and 'certify'. Findings about the records are warnings
% (nlmodes:warning), and in test.points.findings and test.summary.
result = nlmodes.internal.compute({'experiment', 'extract'}, {'force'}, scene, varargin);
end
