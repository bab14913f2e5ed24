# documented FILE ROW NUMBER...: says which of the numbers the row of the document's table lacks. No failure: the documented
# ones are those of one compiler. Sourced by the checks.
documented() {
    local file=$1 row number
    row=$(awk -v start="| $2 |" 'index($0, start) == 1' "$file")
    shift 2
    for number in "$@"; do
        number=$(sed ':a;s/\B[0-9]\{3\}\>/,&/;ta' <<<"$number")
        grep -qwF -- "$number" <<<"$row" || echo "$file: measured $number, not in this row: $row" >&2
    done
}
