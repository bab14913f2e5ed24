// Learning curves: a line a seed, in its row's colour; what it does not learn from is dashed.

function learning({ learning, drivers }) {
  const find = (id) => document.getElementById(id);
  const palette = colours(drivers);
  const draw = (host, figure, label, range) => {
    const series = learning.flatMap((curve) => {
      const line = (scores) => scores[figure].map((value, i) => [curve.done[i], value]);
      const colour = palette.get(curve.driver);
      return [
        { points: line(curve.train), colour, width: 1.8, opacity: 0.9 },
        { points: line(curve.validation), colour, width: 1.2, dash: "4 4", opacity: 0.55 },
      ];
    });
    lineChart(host, { series, x: { label: "share of the training, %", low: 0, high: 100 }, y: { label, ...range } });
  };
  find("learning").hidden = false;
  draw(find("learning-reward"), "reward", "reward a step", {});
  draw(find("learning-accuracy"), "priority_accuracy", "priority accuracy", { high: 1 });
  const rows = [...new Set(learning.map((curve) => curve.driver))];
  legend(find("learning-legend"), [
    ...rows.map((name) => ({ name, colour: palette.get(name) })),
    { name: "on the validation file", colour: "var(--soft)", dash: true },
  ]);
}
