// SPDX-License-Identifier: Apache-2.0
#include "cli/command/completion_scripts.h"

#include <stddef.h>
#include <string.h>

static const char bash[] =
    "# Completion of march and marchd for bash, as `march completion bash` prints it.\n"
    "_march() {\n"
    "    local current=${COMP_WORDS[COMP_CWORD]} line word\n"
    "    COMPREPLY=()\n"
    "    [ \"$current\" != = ] || current=\n"
    "    while IFS= read -r line; do\n"
    "        case $line in\n"
    "        :files) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- \"$current\") ;;\n"
    "        :folders) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- \"$current\") ;;\n"
    "        :json)\n"
    "            compopt -o filenames\n"
    "            mapfile -t COMPREPLY < <(compgen -d -- \"$current\"; compgen -f -X '!*.json' -- \"$current\")\n"
    "            ;;\n"
    "        *)\n"
    "            word=${line%%$'\\t'*}\n"
    "            [[ $word != \"$current\"* ]] || COMPREPLY+=(\"$word\")\n"
    "            ;;\n"
    "        esac\n"
    "    done < <(\"${COMP_WORDS[0]/#\\~/$HOME}\" completion words -- \"${COMP_WORDS[@]:1:COMP_CWORD}\" 2>/dev/null)\n"
    "}\n"
    "_marchd() {\n"
    "    local current=${COMP_WORDS[COMP_CWORD]}\n"
    "    COMPREPLY=()\n"
    "    [[ $current != -* ]] || mapfile -t COMPREPLY < <(compgen -W \"$(\"${COMP_WORDS[0]/#\\~/$HOME}\" --help "
    "2>/dev/null |\n"
    "        grep -oE -- '--[a-z][a-z-]+' | sort -u)\" -- \"$current\")\n"
    "}\n"
    "complete -F _march march\n"
    "complete -o default -F _marchd marchd\n";

static const char zsh[] =
    "#compdef march marchd\n"
    "# Completion of march and marchd for zsh, as `march completion zsh` prints it.\n"
    "_march_words() {\n"
    "    local line\n"
    "    local -a offers\n"
    "    for line in \"${(@f)$(${~words[1]} completion words -- \"${(@Q)words[2,CURRENT]}\" 2>/dev/null)}\"; do\n"
    "        case $line in\n"
    "        '') ;;\n"
    "        :files) compset -P '--*='; _files; return ;;\n"
    "        :folders) compset -P '--*='; _files -/; return ;;\n"
    "        :json) _files -g '*.json'; return ;;\n"
    "        *) offers+=(\"${${line%%$'\\t'*}//:/\\\\:}:${line#*$'\\t'}\") ;;\n"
    "        esac\n"
    "    done\n"
    "    _describe 'march' offers\n"
    "}\n"
    "_march_daemon() {\n"
    "    if [[ $PREFIX == -* ]]; then\n"
    "        compadd -- ${(u)$(${~words[1]} --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]+')}\n"
    "    else\n"
    "        _files\n"
    "    fi\n"
    "}\n"
    "_march() {\n"
    "    case $service in marchd) _march_daemon ;; *) _march_words ;; esac\n"
    "}\n"
    "if [[ ${funcstack[1]-} == _march ]]; then\n"
    "    _march\n"
    "else\n"
    "    compdef _march march marchd\n"
    "fi\n";

static const char fish[] =
    "# Completion of march and marchd for fish, as `march completion fish` prints it.\n"
    "function __march_words\n"
    "    set -l words (commandline -opc)\n"
    "    set -l program $words[1]\n"
    "    set -e words[1]\n"
    "    for line in ($program completion words -- $words \"$(commandline -ct)\" 2>/dev/null)\n"
    "        switch $line\n"
    "            case :files\n"
    "                __fish_complete_path (commandline -ct)\n"
    "            case :folders\n"
    "                __fish_complete_directories (commandline -ct)\n"
    "            case :json\n"
    "                __fish_complete_suffix .json\n"
    "            case '*'\n"
    "                printf '%s\\n' $line\n"
    "        end\n"
    "    end\n"
    "end\n"
    "complete -c march -f -a '(__march_words)'\n"
    "complete -c marchd -a \"(marchd --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]+' | sort -u)\"\n";

const char *completion_script(const char *shell)
{
    if (strcmp(shell, "bash") == 0) return bash;
    if (strcmp(shell, "zsh") == 0) return zsh;
    return strcmp(shell, "fish") == 0 ? fish : NULL;
}
