#!/usr/bin/env python3
"""Holds the ABI's headers against the recorded baseline.

  abi.py check    [--headers DIR] [--baseline DIR]   one line for each id that differs; exit code 0: none does
  abi.py record   [--headers DIR] [--baseline DIR]   takes over what may be taken over
  abi.py witness  [--headers DIR]                    prints the C source of the witness

README.md, beside this file, says how the ABI may change. What is compared is an ABI witness: a library that exports one
function for each struct of the headers, because abidiff sees nothing behind `const void* extension(id)`. Exit code 1: something
differs, or may not be recorded; 2: the comparison itself could not be done.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

HERE = pathlib.Path(__file__).resolve().parent
ID = r'(?P<stem>(?:[a-z_]+\.)+[a-z_]+)/(?P<number>\d+)'
TOKEN = re.compile(r'^\#define\s+(?P<macro>PLR_\w+)\s+"(?P<text>[^"]*)"'
                   r'|^\#define\s+PLR_ABI_MAJOR\s+(?P<major>\d+)'
                   r'|\bstruct\s+(?P<struct>\w+)\s*\{'
                   r'|\benum\s*\w*\s*\{(?P<constants>[^}]*)\}', re.MULTILINE)
ABIDW = ['abidw', '--no-corpus-path', '--no-comp-dir-path', '--no-architecture', '--no-elf-needed', '--no-parameter-names',
         '--no-write-default-sizes', '--type-id-style', 'hash', '--load-all-types']
ABIDIFF = ['abidiff', '--no-architecture', '--no-show-locs', '--harmless']
COMPILER = os.environ.get('CC', 'cc')
WHOLE = 'pelorus.abi'  # the id of what belongs to no table: describe.h, plugin.h, entry.h, ...


class Trouble(Exception):
    """The comparison could not be done."""


def run(words, accepted=(0,)):
    try:
        ended = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise Trouble(f'{words[0]} is not installed (tools/setup test)') from None
    if ended.returncode not in accepted:
        raise Trouble(f'{words[0]} failed: {(ended.stderr or ended.stdout).strip()}')
    return ended


class Headers:
    """What the headers of a folder declare, by the id that it belongs to: the one defined last above it in its header."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder).resolve()
        self.names = sorted(path.name for path in self.folder.glob('*.h'))
        if not self.names:
            raise Trouble(f'no headers in {folder}')
        texts = {name: re.sub(r'/\*.*?\*/', '', (self.folder / name).read_text(), flags=re.DOTALL) for name in self.names}
        majors = [m['major'] for text in texts.values() for m in TOKEN.finditer(text) if m['major']]
        self.whole = f'{WHOLE}/{majors[0] if majors else 0}'
        self.structs, self.constants, self.texts = {}, {}, {}
        self.tables = set()  # structs that hold function pointers
        for text in texts.values():
            self._read(text)
        self.ids = sorted({*self.structs, *self.constants, *self.texts})

    def _read(self, text):
        owner = self.whole
        for token in TOKEN.finditer(text):
            if token['text'] is not None and re.fullmatch(ID, token['text']):
                owner = token['text']
                self.structs.setdefault(owner, [])
            elif token['text'] is not None:
                self.texts.setdefault(owner, []).append((token['macro'], token['text']))
            elif token['struct']:
                self.structs.setdefault(owner, []).append(token['struct'])
                body = text[token.end():text.find(f'}} {token["struct"]};', token.end())]
                if '(*' in body:
                    self.tables.add(token['struct'])
            elif token['constants']:
                names = [entry.split('=')[0].strip() for entry in token['constants'].split(',')]
                self.constants.setdefault(owner, []).append([name for name in names if name])

    def includes(self):
        return ''.join(f'#include "{name}"\n' for name in self.names)

    def witness(self, ids):
        """C: a function for each struct, one for each enum (as an enum with a name: most of the headers' have none, and so are
        no function's type), and one for each text, which is part of the function's name."""
        lines = [self.includes()]
        for identity in ids:
            for struct in self.structs.get(identity, []):
                lines.append(f'{struct}* witness_{struct}(void);\n{struct}* witness_{struct}(void) {{ return 0; }}\n')
            for constants in self.constants.get(identity, []):
                # One for each enum, not one for all: abidiff passes over an enumerator whose value another one has as well.
                name = f'witness_constants_{constants[0]}'
                values = ', '.join(f'witness_{constant} = {constant}' for constant in constants)
                lines.append(f'enum {name} {{ {values} }};\nenum {name} {name}(void);\n'
                             f'enum {name} {name}(void) {{ return (enum {name})0; }}\n')
            for macro, text in self.texts.get(identity, []):
                name = f'witness_text_{macro}_is_' + re.sub(r'\W', '_', text)
                lines.append(f'void {name}(void);\nvoid {name}(void) {{}}\n')
        return ''.join(lines)

    def compile(self, text, out):
        source = out.with_suffix('.c')
        source.write_text(text)
        # All types, also those that no witness reaches: _require_complete looks at them.
        all_types = '-fstandalone-debug' if 'clang' in COMPILER else '-fno-eliminate-unused-debug-types'
        run([COMPILER, '-std=c11', '-g', all_types, '-O0', '-shared', '-fPIC', '-I', self.folder, source, '-o', out])

    def records(self, folder):
        """{id: file}: what abidw says of the witness of each."""
        library, xml = folder / 'witness.so', folder / 'witness.xml'
        self.compile(self.witness(self.ids), library)
        run([*ABIDW, library, '--out-file', xml])
        whole = Record(xml)
        self._require_complete(whole)
        files = {}
        for identity in self.ids:
            files[identity] = folder / (re.sub(r'\W', '_', identity) + '.abi')
            whole.write_part(set(re.findall(r'\b(witness_\w+)\(void\);', self.witness([identity]))), files[identity])
        return files

    def _require_complete(self, whole):
        """Every struct and constant that the compiler finds in the headers has a witness."""
        known = {name for names in self.structs.values() for name in names}
        known |= {name for enums in self.constants.values() for names in enums for name in names}
        own = [element for element in whole.root.iter() if (element.get('filepath') or '').startswith(str(self.folder))]
        named = [element for element in own if element.tag in ('class-decl', 'union-decl') and element.get('is-anonymous') != 'yes']
        constants = [value for element in own if element.tag == 'enum-decl' for value in element.findall('enumerator')]
        missing = {element.get('name') for element in [*named, *constants]} - known
        if missing:
            raise Trouble('without a witness, because abi.py cannot read how the headers declare them: ' + ', '.join(sorted(missing)))


class Record:
    """An abixml file, of which parts can be written."""

    def __init__(self, file):
        self.root = ElementTree.parse(file).getroot()
        self.declared = [child for instr in self.root.findall('abi-instr') for child in instr]
        self.place = {}  # type id -> the declaration that it stands in
        for declaration in self.declared:
            for element in declaration.iter():
                if element.get('id'):
                    self.place[element.get('id')] = declaration

    def write_part(self, functions, out):
        """Those functions, and every type that is reached from them."""
        kept = []
        waiting = [element for element in self.declared if element.tag == 'function-decl' and element.get('name') in functions]
        while waiting:
            declaration = waiting.pop()
            if declaration in kept:
                continue
            kept.append(declaration)
            for element in declaration.iter():
                waiting += [self.place[value] for key, value in element.items() if key.endswith('-id') and value in self.place]
        part = ElementTree.Element(self.root.tag, {'version': self.root.get('version')})
        symbols = ElementTree.SubElement(part, 'elf-function-symbols')
        symbols.extend(symbol for symbol in self.root.iter('elf-symbol') if symbol.get('name') in functions)
        instr = ElementTree.SubElement(part, 'abi-instr', {'address-size': '64', 'path': 'witness.c', 'language': 'LANG_C11'})
        instr.extend(declaration for declaration in self.declared if declaration in kept)
        for element in instr.iter():
            for circumstance in ('filepath', 'line', 'column', 'is-non-reachable'):
                element.attrib.pop(circumstance, None)
        ElementTree.indent(part)
        out.write_text(ElementTree.tostring(part, encoding='unicode') + '\n')


def with_older_eyes(now, before, tables, out):
    """Writes `now` without what a reader of `before` does not see: members after the end of structs that tell their size,
    further constants, further structs."""
    def of_kind(tree, tag):
        return {element.get('name'): element for element in tree.iter(tag)}

    tree, old = ElementTree.parse(now), ElementTree.parse(before)
    old_structs, old_enums = of_kind(old, 'class-decl'), of_kind(old, 'enum-decl')
    for name, struct in of_kind(tree, 'class-decl').items():
        members = struct.findall('data-member')
        tells_its_size = any(member.find('var-decl').get('name') == 'struct_size' for member in members)
        if name not in old_structs or name in tables or not tells_its_size:
            continue
        end = int(old_structs[name].get('size-in-bits', 0))
        if int(struct.get('size-in-bits', 0)) <= end:
            continue
        for member in members:
            # What fills the gap at the old end stays: an older caller's struct_size says that it is there, and it is not.
            if int(member.get('layout-offset-in-bits')) >= end:
                struct.remove(member)
        struct.set('size-in-bits', str(end))
    for name, enum in of_kind(tree, 'enum-decl').items():
        if name in old_enums:
            known = {value.get('name') for value in old_enums[name].findall('enumerator')}
            for value in enum.findall('enumerator'):
                if value.get('name') not in known:
                    enum.remove(value)
    for tag in ('elf-symbol', 'function-decl'):
        known = of_kind(old, tag)
        for parent in list(tree.iter()):
            for child in parent.findall(tag):
                if child.get('name') not in known:
                    parent.remove(child)
    tree.write(out)


def differences(before, now):
    """abidiff's report, or "" if the two are the same."""
    ended = run([*ABIDIFF, before, now], accepted=(0, 4, 8, 12))
    return '' if ended.returncode == 0 else ended.stdout.strip()


def compare(before, now, tables):
    """`new`, `same`, `grew` or `changed`, and abidiff's report."""
    if not before.exists():
        return 'new', ''
    report = '' if before.read_text() == now.read_text() else differences(before, now)
    if not report:
        return 'same', ''
    trimmed = now.with_suffix('.trimmed.abi')
    with_older_eyes(now, before, tables, trimmed)
    return ('changed' if differences(before, trimmed) else 'grew'), report


class Policy:
    """What may be done with what was found."""

    def __init__(self, ids, recorded):
        self.ids, self.recorded = ids, recorded
        self.all_frozen = not any(self._says_draft(identity) for identity in ids)

    @staticmethod
    def _says_draft(identity):
        return '.draft/' in identity

    def is_draft(self, identity):
        # What belongs to no table has no id that could say so: it is a draft as long as any table is one.
        return self._says_draft(identity) or (identity.startswith(f'{WHOLE}/') and not self.all_frozen)

    @staticmethod
    def parts(identity):
        match = re.fullmatch(ID, identity)
        return match['stem'], int(match['number'])

    def raised(self, identity):
        stem, number = self.parts(identity)
        return f'{stem}/{number + 1}'

    def changed(self, identity):
        if not self.is_draft(identity):
            return f'changed, and it is frozen for ever: a change is {self.raised(identity)}, with structs of its own beside these'
        raised = f'PLR_ABI_MAJOR to {self.parts(identity)[1] + 1}' if identity.startswith(f'{WHOLE}/') else f'it to {self.raised(identity)}'
        return f'changed: raise {raised}, then record it'

    def new(self, identity):
        """Why it may not be recorded, or ""."""
        stem, number = self.parts(identity)
        base = stem.removesuffix('.draft')
        for other in self.recorded:
            other_stem, other_number = self.parts(other)
            if other_stem == stem and other_number > number:
                return f'comes after {other}, which was there already'
            if other_stem == base and stem != base:
                return f'comes after {other}, which is frozen'
        return ''

    def gone(self, identity):
        """Why it may not go, or ""."""
        return '' if self.is_draft(identity) else 'is frozen for ever, but no header has it any more'


def indented(report):
    return ''.join(f'    {line}\n' for line in report.splitlines() if line.strip())


def look(headers, baseline, folder):
    """[(id, verdict, reason why it may not be recorded, report, file)] of all that differs."""
    recorded = sorted(str(path.relative_to(baseline).with_suffix('')) for path in baseline.rglob('*.abi') if path.is_file())
    policy = Policy(headers.ids, recorded)
    found = []
    for identity, now in headers.records(folder).items():
        verdict, report = compare(baseline / f'{identity}.abi', now, headers.tables)
        reason = policy.changed(identity) if verdict == 'changed' else policy.new(identity) if verdict == 'new' else ''
        if verdict != 'same':
            found.append((identity, verdict, reason, report, now))
    for identity in sorted({*recorded} - {*headers.ids}):
        found.append((identity, 'gone', policy.gone(identity), '', None))
    return found


def check(found):
    texts = {'grew': 'grew at its end, which is allowed: record it', 'new': 'is not recorded: record it',
             'gone': 'is recorded, but no header has it any more: record that'}
    for identity, verdict, reason, report, _ in found:
        print(f'{identity}: {reason or texts[verdict]}\n{indented(report)}', end='')
    return 1 if found else 0


def record(found, baseline):
    refused = False
    for identity, verdict, reason, report, now in found:
        file = baseline / f'{identity}.abi'
        if reason:
            print(f'{identity}: {reason}\n{indented(report)}', end='')
            refused = True
        elif verdict == 'gone':
            file.unlink()
            print(f'{identity}: taken out')
        else:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(now.read_text())
            print(f'{identity}: recorded')
    for folder in [path for path in baseline.glob('*') if path.is_dir() and not any(path.iterdir())]:
        folder.rmdir()
    return 1 if refused else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('command', choices=['check', 'record', 'witness'])
    parser.add_argument('--headers', type=pathlib.Path, default=HERE.parent.parent / 'sdk/include/pelorus/abi')
    parser.add_argument('--baseline', type=pathlib.Path, default=HERE / 'baseline')
    arguments = parser.parse_args()
    try:
        headers = Headers(arguments.headers)
        if arguments.command == 'witness':
            print(headers.witness(headers.ids), end='')
            return
        with tempfile.TemporaryDirectory() as folder:
            found = look(headers, arguments.baseline, pathlib.Path(folder))
            sys.exit(check(found) if arguments.command == 'check' else record(found, arguments.baseline))
    except Trouble as trouble:
        print(f'abi.py: {trouble}', file=sys.stderr)
        sys.exit(2)


if __name__ == '__main__':
    main()
