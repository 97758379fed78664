// Shares of the linear modes in the kinetic energy over the modal amplitude: a panel for each of the modes with the largest
// ones, all branches in each.

function participationSpec(onHover, onChoose) {
  const modes = DATA.strongestModes;
  const panels = modes.map(mode => ({
    label: `energy share, mode ${mode + 1}`, kind: "linear", symbols: [],
    curves: DATA.branches.map((branch, key) => ({
      key, x: branch.amplitude, y: branch.participation[mode] || [], color: branch.color, breaks: new Set(branch.resumed), corners: cornersOf(branch),
    })).filter(curve => curve.y.length),
  }));
  const describe = ({ key }, index) => {
    const branch = DATA.branches[key];
    const share = mode => significant((branch.participation[mode] || [])[index], 5);
    return [
      `${branch.label}: point ${numberOf(branch, index)}`, `frequency: ${hertz(branch.frequency[index])}`,
      `modal amplitude: ${significant(branch.amplitude[index], 5)} m √kg`,
      ...modes.map(mode => `share of mode ${mode + 1} in the kinetic energy: ${share(mode)}`),
    ];
  };
  return {
    name: "Shares in the kinetic energy over modal amplitude", x: { label: AMPLITUDE_LABEL, kind: "linear" }, panels, height: 200, describe, onHover, onChoose,
  };
}
