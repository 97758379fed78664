% Two masses in a row and a one-sided spring: the forced response over frequency, with both folds, and its stability.
%
% 1 kg each on springs of 1 N/m with dampers of 0.03 Ns/m; a spring of 100 N/m one metre before the first mass; 0.1 N at
% the second. The same oscillator is an example of NLvib, where it takes 1024 samples a period; here instants of contact
% are exact.
K = [1, -1; -1, 2];                                        % between the masses, and from the second one to the ground
M = eye(2);
scene = nlmodes.structure(K, M, 'title', 'Two masses before a one-sided spring');
scene.contact = struct('node', 1, 'normal', [1, 0, 0], 'gap_m', 1, 'stiffness_n_m', 100);
scene.damping.rayleigh.stiffness_s = 0.03;
scene.force = struct('node', 2, 'direction', [1, 0, 0]);
scene.response = struct('kind', 'frequency', 'frequency_hz', [0.5, 0.8] / (2 * pi), 'levels_n', 0.1);
scene.reduction = struct('kind', 'open-modes', 'modes', 2);
scene.method.harmonics = 63;                              % with fewer, the stability of some motions is left open
result = nlmodes.run(scene, 'output.stability', 'always');

branch = result.branch;
amplitude = branch.drive_fundamental_m;                    % fundamental of the driven mass
unstable = amplitude;
unstable(branch.stable ~= 0) = NaN;
fprintf('largest amplitude of the second mass %.5f m at %.5f rad/s\n', max(amplitude), ...
  2 * pi * branch.frequency_hz(amplitude == max(amplitude)));
figure(1); clf
plot(2 * pi * branch.frequency_hz, amplitude, 'b-', 2 * pi * branch.frequency_hz, unstable, 'r-', 'linewidth', 1.5);
xlabel('excitation frequency in rad/s');
ylabel('fundamental of the second mass in m');
legend('stable', 'unstable', 'location', 'northwest');
