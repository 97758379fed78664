function summary = json(folder)
%JSON  summary.json of a directory as a structure; [] where there is none.
file = fullfile(folder, 'summary.json');
summary = [];
if isfile(file), summary = jsondecode(nlmodes.internal.text_of(file)); end
end
