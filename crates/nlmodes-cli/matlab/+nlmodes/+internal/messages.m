function text = messages(said)
%MESSAGES  What the command line says of mistakes, without its warnings before them.
at = regexp(said, '(^|\n)error', 'once');
if isempty(at), at = 1; end
text = strtrim(said(at:end));
end
