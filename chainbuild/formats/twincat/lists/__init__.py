"""From text to typed configuration: channel, axis and tool lists.

In reading order: `values`, `reader`, `container`, `config`, `hdtable`, `named_parameters`, `counts`, `channel`,
`axislist`, `toollist`, `source`.
"""
