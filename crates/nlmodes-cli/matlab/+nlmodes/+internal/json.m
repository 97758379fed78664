function summary = json(folder)
%JSON  summary.json of a directory as a structure; [] where there is none.
%
% `end` is a keyword: its field is xEnd, in MATLAB and in Octave.
file = fullfile(folder, 'summary.json');
summary = [];
if ~isfile(file), return; end
summary = jsondecode(regexprep(nlmodes.internal.text_of(file), '(?<!\\)"end"(\s*:)', '"xEnd"$1'));
end
