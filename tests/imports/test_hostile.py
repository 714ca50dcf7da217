import re

import pytest

from hexapods.domain.errors import InvalidInput
from tests.imports.robots import dog, read, zipped

NESTED = '<replicate count="60">' * 3 + '<geom size="0.01"/>' + "</replicate>" * 3


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ('<include file="/etc/passwd"/>', "it includes passwd, which is another file"),
        (f"<worldbody>{NESTED}</worldbody>", "copies by <replicate> are not made"),
        (
            '<worldbody><body><composite type="cable" count="9 1 1"/></body></worldbody>',
            "<composite>",
        ),
        ('<worldbody><flexcomp name="a" type="grid" count="9 9 9"/></worldbody>', "<flexcomp>"),
        ('<deformable><flex name="a" dim="2"/></deformable>', "<flex>"),
        ('<extension><plugin plugin="mujoco.elasticity.cable"/></extension>', "plugins are not"),
        ('<asset><model name="a" file="/etc/passwd"/></asset>', "other files are not attached"),
        (
            '<worldbody><body name="long"><joint axis="0 0 nan"/></body></worldbody>',
            "finite numbers",
        ),
        ('<worldbody><body name="b" pos="1 x 2"/></worldbody>', "pos must be numbers, not 'x'"),
        ("<worldbody>" + "<body><geom size='1'/></body>" * 301 + "</worldbody>", "elements <body>"),
        (
            "<worldbody><body>" + '<geom size="1"/>' * 2001 + "</body></worldbody>",
            "elements <geom>",
        ),
        ('<asset><mesh name="m" builtin="sphere" params="9"/></asset>', "MuJoCo refuses the file"),
        (
            '<asset><mesh name="m" vertex="0 0 0 1"/></asset>',
            "MuJoCo refuses the file in line 36 (m)",
        ),
        ('<worldbody><body><geom type="cube" size="1"/></body></worldbody>', "MuJoCo refuses"),
        ('<worldbody><body name="trunk"/></worldbody>', "MuJoCo refuses the file"),
    ],
)
def test_what_a_robot_must_not_have_is_refused(section: str, said: str) -> None:
    with pytest.raises(InvalidInput, match=re.escape(said)):
        read(dog(sections=section))


def test_the_line_is_that_of_the_file() -> None:
    text = dog().replace('<position joint="RR_calf_joint"', '\n\n<position joint="none"')
    line = text[: text.index('joint="none"')].count("\n") + 1

    with pytest.raises(InvalidInput, match=f"in line {line}"):
        read(text)


@pytest.mark.parametrize(
    "section",
    [
        '<asset><texture name="t" file="/etc/passwd"/><material name="m" texture="t"/></asset>',
        '<asset><texture name="t" builtin="flat" width="100000" height="100000"/></asset>',
        '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
        '<size memory="900G" nuserdata="1000000000"/>',
        '<custom><numeric name="a" size="1000000000"/></custom>',
        '<visual><global offwidth="1000000000"/></visual>',
        '<option timestep="1e-300" iterations="1000000000"/>',
        '<sensor><user dim="1000000000"/></sensor>',
    ],
)
def test_what_is_no_body_is_left_out(section: str) -> None:
    assert len(read(dog(sections=section)).legs) == 4


@pytest.mark.parametrize(
    ("folder", "path"),
    [
        ("", "../../../etc/passwd"),
        ("", "/etc/passwd"),
        ("", "file:///etc/passwd"),
        ("", "http://127.0.0.1/passwd"),
        ("/etc", "passwd"),
    ],
)
def test_meshes_are_looked_for_in_the_zip_only(folder: str, path: str) -> None:
    mesh = f'<compiler meshdir="{folder}"/><asset><mesh name="m" file="{path}"/></asset>'

    robot = read(zipped({"dog.xml": dog(sections=mesh)}))

    assert any("passwd" in sentence and "missing" in sentence for sentence in robot.repairs)
    assert robot.model == read(dog()).model
