# Makes a manual page of what help_pages.sh prints. The rest of the page is written by hand and appended.
# Usage: awk -v name=fairway -v section=1 -v version=0.1.0 -f man_page.awk
# CLI11 begins a description in column 31, on the next line where the term is too long.

function escaped(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  if (text ~ /^[.']/) text = "\\&" text
  return text
}

function sentence(text) {
  if (text != "" && text !~ /[.:;]$/) text = text "."
  return text
}

# "--noise FLOAT:FLOAT in [0 - 10]=0.2" becomes a term; what else it tells goes into `told`.
function term(text,   option, rest, at) {
  told = ""
  at = index(text, " ")
  option = at ? substr(text, 1, at - 1) : text
  rest = at ? substr(text, at + 1) : ""
  if (sub(/ ?REQUIRED$/, "", rest)) told = told " Needed."
  if (match(rest, / \(Env:.*\)$/)) rest = substr(rest, 1, RSTART - 1)
  if (match(rest, /=.*$/)) {
    # This default is the number of processors, here that of the machine that makes the page.
    at = option == "--workers" ? "one per processor" : substr(rest, RSTART + 1)
    told = told " Default: " at "."
    rest = substr(rest, 1, RSTART - 1)
  }
  if (match(rest, /in \[[^]]*\]/)) {
    at = substr(rest, RSTART + 4, RLENGTH - 5)
    sub(/ - /, " to ", at)
    told = told " From " at "."
  }
  sub(/^TEXT:.*$/, "TEXT", rest)
  if (rest ~ /^(U?INT|FLOAT):/) sub(/:.*$/, "", rest)
  if (option !~ /^-/) sub(/^TEXT ?/, "", rest)
  option = escaped(option)
  gsub(/,/, "\\fR, \\fB", option)
  option = "\\fB" option "\\fR"
  return rest == "" ? option : option " \\fI" escaped(rest) "\\fR"
}

function entry(text, description) {
  sub(/^ +/, "", text)
  sub(/ +$/, "", text)
  if (text ~ /^-h,--help/ && words != "") return
  if (words == "" && text ~ /^-h,--help/) description = "Print a summary and exit"
  print ".TP"
  print term(text)
  print escaped(sentence(description) told)
}

function heading(title) {
  if (words == "") print ".SH " toupper(title)
}

# One page of help, which stands in lines[1..count].
function show(   i, line) {
  if (words == "submit") return  # a program with a page of its own
  if (words == "") {
    line = lines[1]
    sub(/^[^:]*: /, "", line)
    printf ".TH \"%s\" \"%s\" \"\" \"fairway %s\" \"fairway\"\n", toupper(name), section, version
    print ".SH NAME\n" escaped(name) " \\- " escaped(line)
  }
  for (i = 2; i <= count; i++) {
    line = lines[i]
    if (line ~ /^Usage: /) {
      sub(/^Usage: /, "", line)
      if (words == "") print ".SH SYNOPSIS\n.B " escaped(line)
      else print ".SS " escaped(line) "\n" escaped(sentence(lines[1]))
    } else if (line ~ /^(Options|Positionals|Subcommands):$/) {
      sub(/:$/, "", line)
      heading(line == "Positionals" ? "arguments" : line == "Subcommands" ? "commands" : line)
      footer = 0
    } else if (line ~ /^  [^ ]/) {
      if (lines[i + 1] ~ /^                              [^ ]/) {
        entry(line, substr(lines[i + 1], 31))
        i++
      } else {
        entry(substr(line, 1, 30), substr(line, 31))
      }
    } else if (line == "") {
      blank = 1
    } else {
      if (!footer) print ".SH DETAILS"
      else if (blank) print ".PP"
      footer = 1
      blank = 0
      print escaped(line)
    }
  }
}

/^@@/ {
  if (count) show()
  if (NF > 1 && !details++) print ".SH COMMANDS IN DETAIL"
  words = substr($0, 4)
  count = footer = blank = 0
  split("", lines)
  next
}

# Some begin with an empty line.
count || $0 != "" { lines[++count] = $0 }

END { show() }
