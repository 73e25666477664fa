# Makes a bash completion of what help_pages.sh prints.
# Usage: awk -v name=fairway -f completion.awk
# Where nothing is offered bash offers files.

/^@@/ {
  words = substr($0, 4)
  if (words != "") {
    paths[++path_count] = words
    # Groups are not listed by the program's own help.
    if (words !~ / / && !(words in listed)) verbs[""] = verbs[""] " " words
  }
  next
}
/^(Options|Positionals|Subcommands|Usage).*:/ { part = $1 }
part == "Subcommands:" && /^  [a-z]/ {
  if ($1 == "worker") next
  verbs[words] = verbs[words] " " $1
  if (words == "") listed[$1] = 1
}
part == "Options:" && /^  -/ {
  spellings = $1
  gsub(/,/, " ", spellings)
  options[words] = options[words] " " spellings
  # An option is followed by the name of its value or, in column 31, by its description.
  if (NF < 2 || index($0, " " $2) + 1 == 31) next
  value = $2
  sub(/=.*$/, "", value)
  count = split(spellings, each, " ")
  for (i = 1; i <= count; i++) {
    key = words ":" each[i]
    if (value ~ /\|/) {
      gsub(/\|/, " ", value)
      choices = choices "    \"" key "\") COMPREPLY=($(compgen -W \"" value "\" -- \"$word\")); return ;;\n"
    } else if (value == "DIR") {
      choices = choices "    \"" key "\") COMPREPLY=($(compgen -d -- \"$word\")); return ;;\n"
    } else {
      choices = choices "    \"" key "\") return ;;\n"
    }
  }
}

END {
  f = "_" name
  gsub(/-/, "_", f)
  print "# bash completion of " name ", made of its --help."
  print f "() {"
  print "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verb= options= verbs= i"
  if (path_count) {
    print "  for ((i = 1; i < COMP_CWORD; ++i)); do"
    print "    case \"${verb:+$verb }${COMP_WORDS[i]}\" in"
    for (i = 1; i <= path_count; i++) print "      \"" paths[i] "\") verb=\"" paths[i] "\" ;;"
    print "    esac\n  done"
  }
  print "  case \"$verb:$before\" in\n" choices "  esac"
  print "  case \"$verb\" in"
  for (i = 0; i <= path_count; i++) {
    words = i ? paths[i] : ""
    print "    \"" words "\") options=\"" substr(options[words], 2) "\" verbs=\"" substr(verbs[words], 2) "\" ;;"
  }
  print "  esac"
  print "  [[ $word == -* ]] || options="
  print "  COMPREPLY=($(compgen -W \"$options $verbs\" -- \"$word\"))"
  print "}"
  print "complete -o default -F " f " " name
}
