#!/usr/bin/env bash
# Checks the Rocq development, and that its theorems rest on nothing but the axioms of the real numbers (axioms.txt).
# Root on Debian gets what it needs. Exit code 77: Rocq cannot be had, and nothing was checked.
set -euo pipefail
cd "$(dirname "$0")"

ready() { command -v coqc >/dev/null && [ -d "$(coqc -where)/user-contrib/Coquelicot" ]; }

if ! ready && command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
    apt-get -qq -o DPkg::Lock::Timeout=300 update
    DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 install -y --no-install-recommends \
        coq libcoq-coquelicot make >/dev/null || true
fi
if ! ready; then
    echo "SKIPPED: the Rocq proofs were not checked: no coqc with Coquelicot (Debian: coq, libcoq-coquelicot)" >&2
    exit 77
fi

if grep -nwE 'Admitted|admit|Axiom|Axioms|Parameter|Parameters|Conjecture' ./*.v; then
    echo "proofs: something is taken for granted" >&2
    exit 1
fi
make -s -j"${JOBS:-2}" all

said=$(coqc -q -Q . "" -w none Assumptions.v)
asked=$(grep -c '^Print Assumptions' Assumptions.v)
if [ "$(grep -cE '^(Axioms:|Closed under)' <<<"$said")" != "$asked" ]; then
    echo "proofs: not every theorem tells what it rests on" >&2
    exit 1
fi
# A name stands at the beginning of a line; its type may go on in further ones.
used=$(grep -oE '^[A-Za-z_][A-Za-z0-9_.]*' <<<"$said" | grep -vxE 'Axioms|Closed' | LC_ALL=C sort -u)
if ! diff axioms.txt <(echo "$used"); then
    echo "proofs: the axioms are not those of the real numbers" >&2
    exit 1
fi
echo "proofs: $asked theorems hold, on the axioms of the real numbers"
