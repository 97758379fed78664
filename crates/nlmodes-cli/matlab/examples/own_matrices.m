% Matrices K and M of one's own: a cantilever of Euler-Bernoulli elements, assembled here, before a stop at its tip.
%
% 20 elements, rows of the clamped node left out; each node has a deflection (component 2, uy) and a rotation (component
% 6, rotz).
n = 20;
[len, EI, mass_m] = deal(0.5 / n, 210e9 * 20e-3 * 5e-3 ^ 3 / 12, 7850 * 20e-3 * 5e-3);
Ke = EI / len ^ 3 * [12, 6 * len, -12, 6 * len; 6 * len, 4 * len ^ 2, -6 * len, 2 * len ^ 2; ...
  -12, -6 * len, 12, -6 * len; 6 * len, 2 * len ^ 2, -6 * len, 4 * len ^ 2];
Me = mass_m * len / 420 * [156, 22 * len, 54, -13 * len; 22 * len, 4 * len ^ 2, 13 * len, -3 * len ^ 2; ...
  54, 13 * len, 156, -22 * len; -13 * len, -3 * len ^ 2, -22 * len, 4 * len ^ 2];
[K, M] = deal(sparse(2 * n + 2, 2 * n + 2));
for e = 1:n
  rows = 2 * e - 1:2 * e + 2;
  K(rows, rows) = K(rows, rows) + Ke;
  M(rows, rows) = M(rows, rows) + Me;
end
free = 3:2 * n + 2;
node = ceil((1:2 * n + 2)' / 2);
component = 6 - 4 * mod((1:2 * n + 2)', 2);
dofs = [node, component, (node - 1) * len, zeros(2 * n + 2, 2)];

scene = nlmodes.structure(K(free, free), M(free, free), 'dofs', dofs(free, :), 'title', 'Own beam before a stop');
scene.contact = struct('node', n + 1, 'normal', [0, 1, 0], 'gap_m', 1e-3);
scene.reduction.modes = 6;
scene.method = struct('mode', 1, 'harmonics', 9);
scene.continuation.max_energy_ratio = 5;
nlmodes.check(scene);                                      % what was understood of the matrices
result = nlmodes.run(scene);

linear_hz = sqrt(min(eig(full(K(free, free)), full(M(free, free))))) / (2 * pi);
fprintf('linear %.6f Hz, grazing %.6f Hz, %.6f Hz at five times the energy\n', linear_hz, ...
  result.branch.frequency_hz([1, end]));
figure(1); clf
nlmodes.plot(result);
