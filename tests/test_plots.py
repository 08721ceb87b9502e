"""The pictures of the benches, drawn from made-up numbers. Speaks TAP."""
from program import *  # noqa: F403

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "bench"))
import plots  # noqa: E402


@fact
def marks_of_the_peers_axis_say_the_numbers_where_they_stand(folder):
    rows = [{"code": f"code {k}", "items": 1000, "median": 1e6 * speed, "least": 0.9e6 * speed, "most": 1.1e6 * speed,
             "times": {"code 0": speed}} for k, speed in enumerate((0.3, 2.0, 180.0))]
    figure, axes = plots.plt.subplots()
    plots.peers_panel(axes, {"scene": "scene", "unit": "contact-steps/s", "references": ["code 0"], "rows": rows})
    axes.set_xlim(0.1, 1000)
    figure.canvas.draw()
    marks = {float(tick.label1.get_text()): tick.get_loc() for tick in axes.xaxis.get_major_ticks() if tick.label1.get_text()}
    assert {0.1, 1.0, 10.0, 100.0} <= marks.keys(), marks
    assert all(abs(said - place) <= 1e-6 * place for said, place in marks.items()), marks


if __name__ == "__main__":
    sys.exit(main())
