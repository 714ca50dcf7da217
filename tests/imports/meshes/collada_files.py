"""Writes COLLADA of a square, for the tests."""

SQUARE = "0 0 0 2 0 0 2 1 0 0 1 0"
TRIANGLES = '<triangles count="2">{input}<p>0 9 1 9 2 9 0 9 2 9 3 9</p></triangles>'
POLYLIST = '<polylist count="1">{input}<vcount>4</vcount><p>0 9 1 9 2 9 3 9</p></polylist>'
POLYGONS = '<polygons count="1">{input}<p>0 9 1 9 2 9 3 9</p></polygons>'


def dae(
    polygons: str = TRIANGLES,
    node: str = '<instance_geometry url="#g"/>',
    meter: str = "1",
    square: str = SQUARE,
) -> bytes:
    """Return a square of 2 m times 1 m."""
    inputs = (
        '<input semantic="VERTEX" source="#v" offset="0"/>'
        '<input semantic="NORMAL" source="#n" offset="1"/>'
    )
    return f"""<?xml version="1.0"?>
    <COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema">
      <asset><unit meter="{meter}"/><up_axis>Y_UP</up_axis></asset>
      <library_geometries><geometry id="g"><mesh>
        <source id="s"><float_array id="a" count="12">{square}</float_array>
          <technique_common><accessor source="#a" count="4" stride="3"/></technique_common>
        </source>
        <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
        {polygons.format(input=inputs)}
      </mesh></geometry></library_geometries>
      <library_visual_scenes><visual_scene id="scene"><node>{node}</node></visual_scene>
      </library_visual_scenes>
    </COLLADA>""".encode()
