// Participation of linear modes over the modal amplitude: a panel for each mode, all branches in each.

function participationSpec(onHover, onChoose) {
  const modes = DATA.branches[0].participation.map((_, mode) => mode);
  const panels = modes.map(mode => ({
    label: `participation of mode ${mode + 1}`, kind: "linear", symbols: [],
    curves: DATA.branches.map((branch, key) => (
      { key, x: branch.amplitude, y: branch.participation[mode], color: branch.color, breaks: new Set(branch.resumed) }
    )),
  }));
  const describe = ({ key }, index) => {
    const branch = DATA.branches[key];
    const share = mode => significant(branch.participation[mode][index], 5);
    return [
      `${branch.label}: point ${index}`, `frequency: ${hertz(branch.frequency[index])}`,
      `modal amplitude: ${significant(branch.amplitude[index], 5)} m √kg`,
      ...modes.map(mode => `participation of mode ${mode + 1}: ${share(mode)}`),
    ];
  };
  return {
    name: "Participation over modal amplitude", x: { label: AMPLITUDE.label, kind: "linear" }, panels, height: 200, describe, onHover, onChoose,
  };
}
