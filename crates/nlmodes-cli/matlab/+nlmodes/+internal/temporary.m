function folder = temporary()
%TEMPORARY  A new empty folder that is deleted, with all that is in it, when MATLAB or Octave ends.
%
% The folders of a session are in one, which outlasts `clear all`.
persistent root count remover
if isempty(root)
  mlock;
  root = tempname;
  mkdir(root);
  count = 0;
  remover = onCleanup(removal_of(root)); %#ok<NASGU> acts when it is destroyed
end
count = count + 1;
folder = fullfile(root, sprintf('%d', count));
mkdir(folder);
end

function removal = removal_of(root)
% Octave has forgotten the functions of files by then, and asks before it deletes a folder that is not empty.
if exist('OCTAVE_VERSION', 'builtin')
  removal = @() {confirm_recursive_rmdir(false), rmdir(root, 's')};
else
  removal = @() rmdir(root, 's');
end
end
