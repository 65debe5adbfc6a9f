"""`chainbuild check`: numbered findings of a file."""

from __future__ import annotations

from chainbuild.cli.show import finding_data, print_findings, print_json, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, all_findings
from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector, Finding, Findings, once, still_true


def check(file: str, /, *, json: Json = False, options: MachineOptions = DEFAULT_OPTIONS) -> int:
    """List every finding of a machine file, errors included.

    Reads the whole file and translates every kinematic in it. The exit code is 0 if the machine can be built, even with
    warnings, and 1 if the file is refused.

    Example: `chainbuild check kr6r900`

    Args:
        file: A machine file, or the name of a shipped machine.
        json: Print JSON.
        options: Which kinematic.
    """
    from chainbuild.formats.load import check as check_file

    chosen = options.choices()
    findings = check_file(file, overlay=options.overlay, tool=options.tool)
    # What an option settles is no longer open; the selection below is built with it.
    findings = still_true(findings, chosen)
    refused = any(finding.severity == "error" for finding in findings)
    if options.selects and not refused:
        findings = _with_selection(file, options, findings)
        refused = any(finding.severity == "error" for finding in findings)
    if json:
        print_json(
            "check", {"file": file, "refused": refused, "findings": [finding_data(finding) for finding in findings]}
        )
    else:
        print_findings(findings)
        say(f"{file}: {_verdict(findings, refused)}")
    return 1 if refused else 0


def _with_selection(file: str, options: MachineOptions, findings: tuple[Finding, ...]) -> Findings:
    """Return the findings and those of the kinematic, tool and conventions that the options select."""
    from chainbuild.robot import Robot

    collector = Collector(strict=False, findings=list(findings))
    try:
        machine = options.machine(file)
        collector.findings.extend(all_findings(machine, Robot(options.chain(machine)).chain))
    except ChainbuildError as error:
        collector.add_error(error)
    return once(collector.findings)


def _verdict(findings: tuple[Finding, ...], refused: bool) -> str:
    counts = {severity: sum(f.severity == severity for f in findings) for severity in ("error", "warning", "info")}
    told = ", ".join(f"{n} {severity}{'s' * (n != 1 and severity != 'info')}" for severity, n in counts.items() if n)
    return ("refused" if refused else "accepted") + (f" ({told})" if told else ", no findings")
