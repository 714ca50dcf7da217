"""The document in an upload that describes a robot: found, made whole, and read within bounds.

- `folder` packs the files of a folder or a repository that describe a robot; `upload` unpacks, and
  finds files by the ends of their paths.
- `robot_document` chooses the document that is the robot. `xml` reads it, `lenient_xml` first if it
  is not well-formed. `includes` puts what MJCF includes in its place; `xacro` expands macros, by
  `xacro_scope`, `expressions` and `yaml_values`.
- `other_formats` says what any other file is, and what to do with it.
"""
