//! Every malformed recipe we could think of: one clear message, with line and column.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::run;

/// Name of the case, file name, text, settings, the whole error.
type Case = (
    &'static str,
    &'static str,
    &'static [&'static str],
    &'static str,
);

// One case a line.
#[rustfmt::skip]
const CASES: &[Case] = &[
    ("a.toml", "", &[], "a.toml:1:1: version: the recipe does not say its version; write `version = 1` at its beginning"),
    ("a.toml", "# only\n# comments\n", &[], "a.toml:1:1: version: the recipe does not say its version; write `version = 1` at its beginning"),
    ("a.toml", "\n\n   \n", &[], "a.toml:1:1: version: the recipe does not say its version; write `version = 1` at its beginning"),
    ("a.toml", "[[warp]]\nkind = \"shift\"\n", &[], "a.toml:1:1: version: the recipe does not say its version; write `version = 1` at its beginning"),
    ("a.toml", "version = \"1\"", &[], "a.toml:1:11: version: the version is a number, and this is the text \"1\"; write `version = 1`"),
    ("a.toml", "version = 2\n", &[], "a.toml:1:11: version: version 2 of recipes is not known here; the version is 1"),
    ("a.toml", "version = 1.5\n", &[], "a.toml:1:11: version: version 1.5 of recipes is not known here; the version is 1"),
    ("a.toml", "name = \"x\"\nversion = true\n", &[], "a.toml:2:11: version: the version is a number, and this is the truth value true; write `version = 1`"),
    ("a.json", "{\"version\": 2}", &[], "a.json:1:13: version: version 2 of recipes is not known here; the version is 1"),
    ("a.json", "{}", &[], "a.json:1:1: version: the recipe does not say its version; write `\"version\": 1` at its beginning"),
    ("a.json", "", &[], "a.json:1:1: version: the recipe does not say its version; write `version = 1` at its beginning"),
    ("a.json", "[1, 2]", &[], "a.json:1:1: a recipe is a table of keys, and this is a list; begin with { \"version\": 1"),
    ("a.json", "[]", &[], "a.json:1:1: a recipe is a table of keys, and this is an empty list; begin with { \"version\": 1"),
    ("a.json", "null", &[], "a.json:1:1: a recipe is a table of keys, and this is nothing (null); begin with { \"version\": 1"),
    ("a.toml", "version = 1\n[warp]\nkind = \"shift\"\n", &[], "a.toml:2:2: warp: `warp` is a list of tables, and this is a table; write [[warp]], with two brackets"),
    ("a.toml", "version = 1\nwarp = 3\n", &[], "a.toml:2:1: warp: `warp` is a list of tables, and this is the number 3; begin each warp with [[warp]]"),
    ("a.toml", "version = 1\nwarp = [3]\n", &[], "a.toml:2:9: warp.0: a warp is a table, and this is the number 3"),
    ("a.toml", "version = 1\n[[warps]]\nkind = \"shift\"\n", &[], "a.toml:2:3: warps: unknown key `warps`; did you mean `warp`? known here: version, warp, grid, track, time, motion, space, mapping, name, description"),
    ("a.toml", "version = 1\nkind = \"shift\"\noffset = [1, 2, 3]\n", &[], "a.toml:2:1: kind: this stands outside of any warp; begin each warp with [[warp]]"),
    ("a.toml", "version = 1\nspace = \"lokal\"\n", &[], "a.toml:2:9: space: the text \"lokal\" is no space; write \"world\" (where the scene places each mesh) or \"local\" (each mesh in its own coordinates)"),
    ("a.toml", "version = 1\nmask = 0.5\n", &[], "a.toml:2:1: mask: unknown key `mask`; begin each warp with [[warp]]"),
    ("a.toml", "version = 1\nname = 5\ndescription = [\"x\"]\n", &[], "a.toml:2:8: name: the number 5 where text in quotes was expected\na.toml:3:15: description: a list where text in quotes was expected"),
    ("a.json", "{\"version\": 1, \"warp\": {\"kind\": \"shift\"}}", &[], "a.json:1:16: warp: `warp` is a list of tables, and this is a table; write \"warp\": [{ … }]"),
    ("a.json", "{\"version\": 1,\n \"warp\": [null]}", &[], "a.json:2:11: warp.0: a warp is a table, and this is nothing (null)"),
    ("a.toml", "version = 1\n[[warp]]\noffset = [1, 2, 3]\n", &[], "a.toml:2:1: warp.0.kind: the warp does not say its kind; add one, such as `kind = \"shift\"`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = 3\n", &[], "a.toml:3:8: warp.0.kind: the kind is a word in quotes, and this is the number 3"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shfit\"\n", &[], "a.toml:3:8: warp.0.kind: no warp is called `shfit`; did you mean `shift`? `anamorph list warps` names them all"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"nothing-like-it\"\n", &[], "a.toml:3:8: warp.0.kind: no warp is called `nothing-like-it`; known here: shift, grow, screw; `anamorph list warps` names them all"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"whirl\"\n", &[], "a.toml:3:8: warp.0.kind: the warp `whirl` works only in the plane, not in space; use it on a model in the plane; `anamorph list warps` names all warps"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"whril\"\n", &[], "a.toml:3:8: warp.0.kind: no warp is called `whril`; did you mean `whirl`, which works only in the plane? `anamorph list warps` names them all"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"\"\n", &[], "a.toml:3:8: warp.0.kind: no warp is called ``; known here: shift, grow, screw; `anamorph list warps` names them all"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nofset = 3\n", &[], "a.toml:5:1: warp.0.ofset: unknown key `ofset`; did you mean `offset`? known here: angle, move, offset, profile, kind, label, enabled, strength, weight, mask, ambient, scaling, schedule, fit"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlable = \"x\"\n", &[], "a.toml:5:1: warp.0.lable: unknown key `lable`; did you mean `label`? known here: angle, move, offset, profile, kind, label, enabled, strength, weight, mask, ambient, scaling, schedule, fit"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ index = 0, by = \"1%\" }, { index = 1, by = \"1%\" },\n  { indx = 2, by = \"1%\" }]\n", &[], "a.toml:6:5: warp.0.move.2.indx: unknown key `indx`; did you mean `index`? known here: blend, by, index"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n[[warp.move]]\nindex = 0\nby = \"1%\"\nblned = \"smooth\"\nq = 1\n", &[], "a.toml:8:1: warp.0.move.0.blned: unknown key `blned`; did you mean `blend`? known here: blend, by, index\na.toml:9:1: warp.0.move.0.q: unknown key `q`; known here: blend, by, index"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = { field = \"radial\", center = \"50%\", radius = 1 }\n", &[], "a.toml:5:28: warp.0.mask.center: unknown key `center`; did you mean `centre`? known here: centre, field, radius"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = { field = \"radal\", center = \"50%\", radius = 1 }\n", &[], "a.toml:5:18: warp.0.mask.field: `field` cannot be `radal`; did you mean `radial`? known here: product, radial"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = { field = \"product\", of = [0.5, { field = \"radial\", centre = \"50%\", radus = 1 }] }\n", &[], "a.toml:5:76: warp.0.mask.of.1.radus: unknown key `radus`; did you mean `radius`? known here: centre, field, radius"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"screw\"\nby = \"angel\"\nangle = \"1rad\"\n", &[], "a.toml:4:6: warp.0.by: `by` cannot be `angel`; did you mean `angle`? known here: angle, slope"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"screw\"\nby = \"slope\"\nangle = \"1rad\"\nrun = 1\nrise = 2\n", &[], "a.toml:5:1: warp.0.angle: unknown key `angle`; known here: by, rise, run, kind, label, enabled, strength, weight, mask, ambient, scaling, schedule, fit"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"shift\", \"offset\": [1, 2, 3],\n  \"mve\": [], \"angle\": \"1rad\", \"mask\": 0.5}]}", &[], "a.json:2:3: warp.0.mve: unknown key `mve`; did you mean `move`? known here: angle, move, offset, profile, kind, label, enabled, strength, weight, mask, ambient, scaling, schedule, fit"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle = 45\n", &[], "a.toml:5:9: warp.0.angle: an angle needs its unit, and 45 has none; write \"45deg\" or \"45rad\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle = \"45\"\n", &[], "a.toml:5:9: warp.0.angle: an angle needs its unit, and 45 has none; write \"45deg\" or \"45rad\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle = \"many deg\"\n", &[], "a.toml:5:9: warp.0.angle: `many deg` is not an angle; write a number and its unit, such as \"45deg\" or \"0.7rad\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\n", &[], "a.toml:2:1: warp.0: `offset` is missing; add `offset`: how far all points move"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2]\n", &[], "a.toml:4:10: warp.0.offset: 2 coordinates where the space has 3; write [x, y, z]"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, \"x\", 2]\n", &[], "a.toml:4:14: warp.0.offset.1: `x` is neither a number nor a percentage; write a number in scene units, or a share of the model's bounds such as \"50%\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = { x = 1 }\n", &[], "a.toml:4:10: warp.0.offset: a table where a list of numbers or percentages, one per coordinate, such as [0, \"50%\", 1.5] was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = \"2\"\n", &[], "a.toml:4:10: warp.0.factor: the text \"2\" where a number was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = [2]\n", &[], "a.toml:4:10: warp.0.factor: a list where a number was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = { index = 0, by = \"1%\" }\n", &[], "a.toml:5:8: warp.0.move: a table where a list was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ index = -3, by = \"1%\" }]\n", &[], "a.toml:5:19: warp.0.move.0.index: the number -3 where a whole number, not negative, was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ index = 1.5, by = \"1%\" }]\n", &[], "a.toml:5:19: warp.0.move.0.index: the number 1.5 where a whole number, not negative, was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ index = 12, by = \"1%\" }]\n", &[], "a.toml:5:19: warp.0.move.0.index: there is no feature 12; the features are 0 to 9"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ by = \"1%\" }]\n", &[], "a.toml:5:9: warp.0.move.0: `index` is missing; add `index`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ index = 1, by = \"1%\", blend = \"smoth\" }]\n", &[], "a.toml:5:41: warp.0.move.0.blend: `smoth` is not known here; did you mean `smooth`? known here: clamp, smooth"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [\"x\"]\n", &[], "a.toml:5:9: warp.0.move.0: the text \"x\" where a table was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nprofile = [[0, 1], [0.5, 0.6, 7]]\n", &[], "a.toml:5:20: warp.0.profile.1: a list of 3 where fewer were expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nprofile = [[0, 1], [0.5]]\n", &[], "a.toml:5:20: warp.0.profile.1: a list of 1 where a list of 2 was expected"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"shift\", \"offset\": [1, 2, 3], \"angle\": null, \"move\": [[]]}]}", &[], "a.json:1:88: warp.0.move.0: an empty list where a table was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlabel = 5\nenabled = \"yes\"\nambient = 0\nscaling = \"compositon\"\n", &[], "a.toml:5:9: warp.0.label: the number 5 where text in quotes was expected\na.toml:6:11: warp.0.enabled: the text \"yes\" where true or false was expected\na.toml:7:11: warp.0.ambient: the number 0 where a number above 0 was expected\na.toml:8:11: warp.0.scaling: no scaling method is called `compositon`; did you mean `composition`? known here: displacement, composition"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nscaling = 1\n", &[], "a.toml:5:11: warp.0.scaling: the number 1 where \"displacement\" or \"composition\" was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nambient = -1\n", &[], "a.toml:5:11: warp.0.ambient: the number -1 where a number above 0 was expected"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = 1.5\n", &[], "a.toml:5:8: warp.0.mask: the mask is 1.5 everywhere, and must be from 0 to 1"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = \"half\"\n", &[], "a.toml:5:8: warp.0.mask: a field is a number or a table with the key `field`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nweight = -1\n", &[], "a.toml:5:10: warp.0.weight: the weight is -1 everywhere, and must be 0 or more"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = { field = \"radial\", centre = \"50%\", radius = 0 }\n", &[], "a.toml:5:53: warp.0.mask.radius: the length is 0, and must be greater than 0; write a positive number or percentage"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = { field = \"product\", of = [1, { field = \"radial\", centre = \"50%\" }] }\n", &[], "a.toml:5:38: warp.0.mask.of.1: `radius` is missing; add `radius`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle = 45deg\n", &[], "a.toml:5:9: `45deg` is neither a number nor text in quotes; write \"45deg\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlabel = body\n", &[], "a.toml:5:9: `body` is neither a number nor text in quotes; write \"body\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle = \n", &[], "a.toml:5:8: a value is missing; write it after the `=`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle\n", &[], "a.toml:5:6: key with no value, expected `=`; write `key = value`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\noffset = [1, 2, 3]\n", &[], "a.toml:5:1: duplicate key `offset`; write each key once"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmove = [{ index = 1,", &[], "a.toml:5:21: unclosed inline table, expected `}`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlabel = \"body", &[], "a.toml:5:14: invalid basic string, expected `\"`; close the text with a quote on the same line"),
    ("a.toml", "version = 1\n[[warp]\nkind = \"shift\"\n", &[], "a.toml:2:8: unclosed array table, expected `]`; a warp begins with two brackets on each side: [[warp]]"),
    ("a.toml", "version = 1\n[[warp\n", &[], "a.toml:2:7: unclosed array table, expected `]]`; a warp begins with two brackets on each side: [[warp]]"),
    ("a.toml", "version = 1\n// a comment\n", &[], "a.toml:2:4: key with no value, expected `=`; a comment in TOML begins with #"),
    ("a.toml", "version: 1\n", &[], "a.toml:1:10: key with no value, expected `=`; write `key = value`"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlabel = 2020-01-01\n", &[], "a.toml:5:9: warp.0.label: a date or time has no meaning in a recipe; put text in quotes"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = nan\n", &[], "a.toml:4:10: warp.0.factor: `nan` is not a finite number; write a finite number"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = -inf\n", &[], "a.toml:4:10: warp.0.factor: `-inf` is not a finite number; write a finite number"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = 1e999\n", &[], "a.toml:4:10: warp.0.factor: `1e999` is not a finite number; write a finite number"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = 0x1ffffffffffffffffff\n", &[], "a.toml:4:10: warp.0.factor: the number `0x1ffffffffffffffffff` is too large"),
    ("a.toml", "version = 1\r\n[[warp]]\r\n\tkind = \"shift\"\r\n\toffset = [1, 2, 3]\r\n\tangle = 45\r\n", &[], "a.toml:5:10: warp.0.angle: an angle needs its unit, and 45 has none; write \"45deg\" or \"45rad\""),
    ("a.toml", "version = 1\rwarp = 3\r", &[], "a.toml:1:13: carriage return must be followed by newline, expected newline"),
    ("a.toml", "été = \"é\"\nversion = 1\n", &[], "a.toml:1:1: invalid unquoted key, expected letters, numbers, `-`, `_`"),
    ("a.toml", "version = 1\nname = \"ééé\"\nwarp = [{ label = \"é\", kind = \"shft\" }]\n", &[], "a.toml:3:31: warp.0.kind: no warp is called `shft`; did you mean `shift`? `anamorph list warps` names them all"),
    ("a.toml", "version = 1\nx.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = 1\n", &[], "a.toml:2:130: tables and lists are nested deeper than 64 levels; no recipe needs that many"),
    ("a.toml", "version = 1\nx\u{7} = 1\n", &[], "a.toml:2:2: invalid unquoted key, expected letters, numbers, `-`, `_`"),
    ("a.json", "{\"version\": 1,}", &[], "a.json:1:15: a comma with nothing after it; remove the comma"),
    ("a.json", "{\"version\": 1, // a comment\n \"warp\": []}", &[], "a.json:1:16: JSON has no comments; remove it, or write the recipe as TOML, where a comment begins with #"),
    ("a.json", "# a comment\n{\"version\": 1}", &[], "a.json:1:1: JSON has no comments; remove it, or write the recipe as TOML, where a comment begins with #"),
    ("a.json", "/* a */ {\"version\": 1}", &[], "a.json:1:1: JSON has no comments; remove it, or write the recipe as TOML, where a comment begins with #"),
    ("a.json", "{\"version\": 1", &[], "a.json:1:13: the file ends in the middle of the recipe; complete it"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"sh\n", &[], "a.json:1:37: a line break or another control character stands inside a string; close the string before the line ends"),
    ("a.json", "{version: 1}", &[], "a.json:1:2: a key in JSON is a string; put the key in double quotes"),
    ("a.json", "{'version': 1}", &[], "a.json:1:2: a key in JSON is a string; put the key in double quotes"),
    ("a.json", "{\"version\": 1} {\"version\": 1}", &[], "a.json:1:16: something follows the end of the recipe; remove it"),
    ("a.json", "{\"version\": 1,\n \"warp\": [{\"kind\": \"shift\", \"kind\": \"grow\"}]}", &[], "a.json:2:29: warp.0.kind: duplicate key `kind`; write each key once"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"grow\", \"factor\": 1e999}]}", &[], "a.json:1:56: the number is too large; write a finite number"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"grow\", \"factor\": NaN}]}", &[], "a.json:1:52: JSON has only finite numbers; write a finite number"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"grow\", \"factor\": +1}]}", &[], "a.json:1:52: a value was expected here; write a number, a string in double quotes, true, false, a list or a table"),
    ("a.json", "{\"version\": 1, \"name\": \"\\ud800\"}", &[], "a.json:1:31: unexpected end of hex escape"),
    ("a.json", "version: 1", &[], "a.json:1:1: a value was expected here; write a number, a string in double quotes, true, false, a list or a table"),
    ("recipe", "{\"version\": 1,\n\n  \"warps\": []}", &[], "recipe:3:3: warps: unknown key `warps`; did you mean `warp`? known here: version, warp, grid, track, time, motion, space, mapping, name, description"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"grow\", \"factor\": -Infinity}]}", &[], "a.json:1:52: JSON has only finite numbers; write a finite number"),
    ("a.json", "{\"version\": 1, \"warp\": [{\"kind\": \"grow\", \"factor\": nan}]}", &[], "a.json:1:52: JSON has only finite numbers; write a finite number"),
    ("a.json", "version = 3\n", &[], "a.json:1:11: version: version 3 of recipes is not known here; the version is 1"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\noffset.x = 1\n", &[], "a.toml:5:1: cannot extend value of type array with a dotted key"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nangle = [45deg]\n", &[], "a.toml:5:10: `45deg` is neither a number nor text in quotes; write \"45deg\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlabel = 'body\n", &[], "a.toml:5:14: invalid literal string, expected `'`; close the text with a quote on the same line"),
    ("a.toml", "version = 1\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n[[warp]\nkind = \"shift\"\n", &[], "a.toml:2:8: unclosed array table, expected `]`; a warp begins with two brackets on each side: [[warp]]"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.angle"], "a.toml: --set warp.0.angle: there is no `=`; write path=value, such as warp.0.angle=30deg"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["=3"], "a.toml: --set =3: a word of the path is empty; write keys and numbers with dots between, such as warp.0.angle"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp..angle=3"], "a.toml: --set warp..angle=3: a word of the path is empty; write keys and numbers with dots between, such as warp.0.angle"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.1.angle=30deg"], "a.toml: --set warp.1.angle=30deg: warp.1: `warp` has one entry, number 0; name one by its number, as in warp.0"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.-1.angle=30deg"], "a.toml: --set warp.-1.angle=30deg: warp.-1: `warp` has one entry, number 0; name one by its number, as in warp.0"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.angle=30deg"], "a.toml: --set warp.angle=30deg: warp.angle: `warp` has one entry, number 0; name one by its number, as in warp.0"),
    ("a.toml", "version = 1", &["warp.0.kind=shift"], "a.toml: --set warp.0.kind=shift: warp: there is no list `warp`; set it whole, as in warp=[…]"),
    ("a.toml", "version = 1\nwarp = []", &["warp.0.kind=shift"], "a.toml: --set warp.0.kind=shift: warp.0: `warp` has no entries; add them in the file"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.kind.x=30deg"], "a.toml: --set warp.0.kind.x=30deg: warp.0.kind.x: `warp.0.kind` is the text \"shift\"; only tables and lists have something inside"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.move.0.by=1%"], "a.toml: --set warp.0.move.0.by=1%: warp.0.move: there is no list `warp.0.move`; set it whole, as in warp.0.move=[…]"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.angle=30"], "a.toml: --set warp.0.angle=30: warp.0.angle: an angle needs its unit, and 30 has none; write \"30deg\" or \"30rad\""),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.angel=30deg"], "a.toml: --set warp.0.angel=30deg: warp.0.angel: unknown key `angel`; did you mean `angle`? known here: angle, move, offset, profile, kind, label, enabled, strength, weight, mask, ambient, scaling, schedule, fit"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.mask=nan"], "a.toml: --set warp.0.mask=nan: warp.0.mask: `nan` is not a finite number; write a finite number"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.offset=[1, 2"], "a.toml: --set warp.0.offset=[1, 2: warp.0.offset: `[1, 2` is not a complete TOML value; close what it opens; text may also stand without quotes"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.move=[{index = 1, by = \"1%\"}]", "warp.0.move.0.index=77"], "a.toml: --set warp.0.move.0.index=77: warp.0.move.0.index: there is no feature 77; the features are 0 to 9"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0.move=[{indx = 1, by = \"1%\"}]", "warp.0.move.0.by=\"2%\""], "a.toml: --set warp.0.move=[{indx = 1, by = \"1%\"}]: warp.0.move.0.indx: unknown key `indx`; did you mean `index`? known here: blend, by, index"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["version=2"], "a.toml: --set version=2: version: version 2 of recipes is not known here; the version is 1"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["warp.0=[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["], "a.toml: --set warp.0=[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[…[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[: warp.0: nested deeper than 64 levels; no recipe needs that many"),
    ("a.toml", "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n", &["a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1"], "a.toml: --set a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1: the path is longer than 64 words"),
];

#[test]
fn every_malformed_recipe_has_its_message() {
    let mut wrong = String::new();
    for (name, text, settings, expected) in CASES {
        let shown = match run(text.as_bytes(), name, settings) {
            Ok(_) => "no error".to_owned(),
            Err(error) => error.to_string(),
        };
        if shown != *expected {
            wrong += &format!("\n{text:?} {settings:?}\n  is  {shown:?}\n  not {expected:?}\n");
        }
    }
    assert!(CASES.len() >= 40);
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn bytes_that_are_no_text() {
    for (bytes, expected) in [
        (
            &b"version = 1\n\xE9 = 1"[..],
            "a:2:1: byte 0xE9 is not UTF-8 text; save the file as UTF-8",
        ),
        (
            b"\xFF\xFEv\0e\0r\0",
            "a:1:1: the file is UTF-16 text; save it as UTF-8",
        ),
        (
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
            "a:1:1: this is not a text file; a recipe is TOML or JSON text",
        ),
        (
            b"\xEF\xBB\xBFversion = 3",
            "a:1:11: version: version 3 of recipes is not known here; the version is 1",
        ),
        (
            b"\xEF\xBB\xBF{\"version\": 3}",
            "a:1:13: version: version 3 of recipes is not known here; the version is 1",
        ),
    ] {
        assert_eq!(
            run(bytes, "a", &[])
                .err()
                .map(|error| error.to_string())
                .as_deref(),
            Some(expected)
        );
    }
}

/// Recipes that try to take the stack or the memory. Run on a small stack, that of a worker thread.
#[test]
fn hostile_sizes_end_in_one_short_message() {
    let words = |n: usize| vec!["a"; n].join(".");
    let nest = |n: usize| format!("{{{} = ", words(n));
    let mut cases = vec![
        format!("version = 1\na = {}", "[".repeat(10_000)),
        format!(
            "version = 1\na = {}{}",
            "[".repeat(10_000),
            "]".repeat(10_000)
        ),
        format!(
            "version = 1\na = {}1{}",
            nest(1).repeat(10_000),
            "}".repeat(10_000)
        ),
        format!(
            "version = 1\na = {}1{}",
            nest(79).repeat(79),
            "}".repeat(79)
        ),
        format!(
            "version = 1\n[{0}]\n{0} = {1}1{2}",
            words(60),
            nest(60).repeat(60),
            "}".repeat(60)
        ),
        format!("version = 1\n{} = 1", words(100_000)),
        format!("version = 1\n[{}]", words(100_000)),
        format!("{{\"version\": 1, \"a\": {}", "[".repeat(100_000)),
        format!(
            "{{\"version\": 1, \"a\": {}{}}}",
            "[".repeat(100),
            "]".repeat(100)
        ),
        "{\"a\":".repeat(100_000),
        "x".repeat(1_000_000),
        format!("version = 1\n{} = 1", "x".repeat(1_000_000)),
        format!("version = 1\nname = \"{}", "x".repeat(1_000_000)),
        format!(
            "version = 1\n[[warp]]\nkind = \"{}\"",
            "shift".repeat(200_000)
        ),
        format!(
            "version = 1\n[[warp]]\nkind = \"shift\"\noffset = \"{}\"",
            "\\u0007".repeat(200_000)
        ),
        "[[warp]]\n".repeat(100_000),
        "[".repeat(1_000_000),
        "\"".repeat(1_000_001),
        "a.".repeat(500_000),
    ];
    // A megabyte of printable garbage.
    let mut state = 1_u64;
    cases.push(
        (0..1_000_000)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                char::from(32 + u8::try_from((state >> 33) % 95).unwrap())
            })
            .collect(),
    );
    let worker = std::thread::Builder::new()
        .stack_size(1 << 20)
        .spawn(move || {
            for (i, text) in cases.iter().enumerate() {
                let Err(error) = run(text.as_bytes(), "a", &[]) else {
                    panic!("case {i} was accepted");
                };
                let shown = error.to_string();
                assert!(shown.chars().count() < 2000, "case {i}: {shown}");
                assert!(
                    !shown.contains('\n') || error.problems.len() > 1,
                    "case {i}: {shown}"
                );
            }
        });
    worker.unwrap().join().unwrap();
}
