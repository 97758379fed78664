function [complete, because] = ends_of(summary)
%ENDS_OF  Whether every branch of a summary reached an end that its scene names, and why the first incomplete one, else
% the last, ended. Motions in time say so themselves.
complete = true;
because = '';
ends = cell(1, 0);
if all(isfield(summary, {'complete', 'ended'}))
  complete = logical(summary.complete);
  because = char(summary.ended);
end
for name = {'xEnd', 'branches', 'curves'}
  if ~isfield(summary, name{1}), continue; end
  parts = summary.(name{1});
  if ~iscell(parts), parts = num2cell(parts(:)'); end
  for k = 1:numel(parts)
    one = parts{k};
    if isfield(one, 'xEnd'), one = one.xEnd; end
    if isfield(one, 'complete') && isfield(one, 'message'), ends{end + 1} = one; end %#ok<AGROW>
  end
end
for k = 1:numel(ends)
  because = ends{k}.message;
  complete = logical(ends{k}.complete);
  if ~complete, return; end
end
end
