function path = program(given)
%NLMODES.PROGRAM  The command line that the toolbox calls.
%
%   nlmodes.program                                        what is called
%   nlmodes.program('C:\tools\nlmodes-cli.exe')            call this one until MATLAB ends
%
% Without a choice it is the value of the environment variable NLMODES_CLI, else `nlmodes-cli` on the search path of the
% system.
persistent chosen
if nargin > 0
  chosen = char(given);
end
path = chosen;
if isempty(path), path = getenv('NLMODES_CLI'); end
if isempty(path), path = 'nlmodes-cli'; end
end
