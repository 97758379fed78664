function folder = directory_of(said)
%DIRECTORY_OF  The directory of the results, from what a run prints; '' where there are none.
%
% A run of several parts prints one for each, below the one that is meant: part 1 of 2: h1, then Results in
% results/rod/h1. One that ended early has `What was found is in` instead.
pattern = '(?:^|\n)(?:Results in|What was found is in) ([^\n]*?)(?:: open [^\n]*)?(?:\n|$)';
found = regexp(said, pattern, 'tokens', 'once');
part = regexp(said, '(?:^|\n)part 1 of \d+: ([^\n]*)', 'tokens', 'once');
folder = '';
if isempty(found), return; end
folder = strtrim(found{1});
if ~isempty(part), folder = folder(1:end - numel(strtrim(part{1})) - 1); end
end
