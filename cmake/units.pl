#!/usr/bin/perl
# Groups sources into units that compile as one: most of a source's compile time goes into headers and templates that its
# neighbours need as well. `perl units.pl OUT TREE LIB LINES < GROUPS` reads one group a line (NAME SOURCE...), writes
# OUT/NAME/unit_N.cpp, each an #include of sources of that group with about LINES lines in all, and prints a line a group:
# NAME and its units, separated by ';'. Units that stay the same are not touched. Quoted includes start
# from LIB or from TREE, where the sources are (a source's own folder is tried first), or from the folder that LIB is in.
#
# A unit must mean what its sources mean alone. Private names (anonymous namespaces, aliases, macros) of a source are seen
# by the sources behind it, so two sources share a unit only where neither mentions a private name of the other, and where
# no header that one brings along declares, in a namespace that the other sees, a name that is private there. All project
# headers of a unit come before its first source, so no header is read in the sight of private names. Whatever
# this reading of C++ misses ends in an error of the compiler (a redefinition, an ambiguous call): rename one of the two.
use strict;
use warnings;

my ($out, $tree, $lib, $lines_wanted) = @ARGV;
(my $root = $lib) =~ s{/[^/]*$}{};
my %keyword = map { $_ => 1 } qw(const constexpr static inline extern struct class union enum typename auto void double float
  int bool char unsigned long short final noexcept override default delete operator return);

# The text without comments, string contents and preprocessor lines, as tokens; what it includes and which macros it defines.
sub tokens_of {
  my ($path) = @_;
  open my $file, '<', $path or die "units.pl: $path: $!\n";
  local $/;
  my $text = <$file>;
  my $count = ($text =~ tr/\n//);
  my @includes = $text =~ /^[ \t]*#[ \t]*include[ \t]*"([^"]+)"/mg;
  my @macros = $text =~ /^[ \t]*#[ \t]*define[ \t]+(\w+)/mg;
  my @tokens;
  pos($text) = 0;
  while (pos($text) < length $text) {
    if ($text =~ /\G\s+/gc) { next }
    if ($text =~ m{\G//[^\n]*}gc || $text =~ m{\G/\*.*?\*/}gcs) { next }
    if ($text =~ /\G#(?:[^\n\\]|\\.)*/gcs) { next }
    if ($text =~ /\GR"([^(]*)\(.*?\)\1"/gcs || $text =~ /\G"(?:[^"\\]|\\.)*"/gcs) { push @tokens, '""'; next }
    if ($text =~ /\G'(?:[^'\\]|\\.)+'/gcs) { push @tokens, "''"; next }
    if ($text =~ /\G([A-Za-z_]\w*)/gc) { push @tokens, $1; next }
    if ($text =~ /\G[0-9.](?:[\w.']|(?<=[eEpP])[+-])*/gc && $& ne '.') { push @tokens, '0'; next }
    pos($text) -= length $& if defined $& && $& eq '.' && substr($text, pos($text) - 1, 1) eq '.';
    if ($text =~ /\G(::|->|\[\[|\]\]|.)/gcs) { push @tokens, $1; next }
  }
  my $heavy = $text =~ /^[ \t]*#[ \t]*include[ \t]*<(?:Eigen|opencv2|CLI)\//m;
  # Half a minute and a gigabyte each: whoever shares a unit with one waits for it.
  my $alone = $text =~ m{^[ \t]*#[ \t]*include[ \t]*<(?:CGAL/|OpenMesh/|pcl/|CImg\.h)}m;
  return { tokens => \@tokens, includes => \@includes, macros => \@macros, lines => $count, heavy => $heavy, alone => $alone };
}

# Names that one statement at namespace level declares -> how (the text of an alias: the same alias twice is no collision).
sub declared {
  my (@t) = @_;
  while (@t && $t[0] eq 'template') {  # the parameter list names nothing outside
    shift @t;
    my $depth = 0;
    while (@t) { my $x = shift @t; $depth++ if $x eq '<'; $depth-- if $x eq '>'; last if $depth <= 0 }
  }
  while (@t && $t[0] eq '[[') { shift @t while @t && $t[0] ne ']]'; shift @t }
  return () unless @t;
  my $text = join ' ', @t;
  if ($t[0] eq 'using') {
    return ($text => $text) if @t > 1 && $t[1] eq 'namespace';
    return @t > 2 && $t[2] eq '=' ? ($t[1] => $text) : ($t[-1] => $text);
  }
  return ($t[1] => $text) if $t[0] eq 'namespace';
  return ($t[-1] => $text) if $t[0] eq 'typedef';
  if ($t[0] =~ /^(?:struct|class|union|enum)$/) {
    my $i = 1;
    $i++ while $i < @t && ($t[$i] eq 'class' || $t[$i] eq 'struct' || $t[$i] eq '[[' || $t[$i] eq ']]' || $t[$i] eq 'nodiscard');
    my @names = $i < @t && $t[$i] =~ /^\w/ && !($i + 1 < @t && $t[$i + 1] =~ /^(?:::|<)$/) ? ($t[$i] => 'type') : ();
    my ($body) = grep { $t[$_] eq '{}' } 0 .. $#t;
    push @names, map { ($_ => 'value') } grep { /^[A-Za-z_]/ } @t[$body + 1 .. $#t] if defined $body;
    return @names;
  }
  my ($round, $angle, $initialised, @names, $last) = (0, 0, 0);
  my $qualified = 0;
  for my $i (0 .. $#t) {
    my $x = $t[$i];
    if ($x eq 'operator') { return () }
    if ($x eq '(' || $x eq '[') {
      if (!$round && !$angle && !$initialised && defined $last) {
        push @names, $last => 'value' unless $qualified;
        return @names if $x eq '(';
        $initialised = 1;
      }
      $round++;
    } elsif ($x eq ')' || $x eq ']') { $round-- }
    elsif (!$round && !$initialised && $x eq '<') { $angle++ }
    elsif (!$round && !$initialised && $x eq '>') { $angle-- if $angle }
    elsif (!$round && !$angle && ($x eq '=' || $x eq '{}' || $x eq ',')) {
      push @names, $last => 'value' if !$initialised && defined $last && !$qualified;
      $initialised = $x ne ',';
      undef $last;
    } elsif (!$round && !$angle && !$initialised && $x =~ /^[A-Za-z_]/ && !$keyword{$x}) {
      $qualified = $i > 0 && $t[$i - 1] eq '::';
      $last = $x;
    }
  }
  push @names, $last => 'value' if !$initialised && defined $last && !$qualified;
  return @names;
}

# Walks the namespaces of a file: names declared at their level, in anonymous ones (private) and in others (open), by namespace.
sub scan {
  my ($path) = @_;
  my $file = tokens_of($path);
  my @t = @{ $file->{tokens} };
  my (@spaces, @statement, %private, %open, %in);
  my $declare = sub {
    my %names = declared(@statement);
    my $where = join '::', grep { $_ ne '' } @spaces;
    my $target = (grep { $_ eq '' } @spaces) ? \%private : \%open;
    $in{$where} = 1 if @statement;
    $target->{$_}{$where} = $names{$_} for keys %names;
    @statement = ();
  };
  my $round = 0;
  for (my $i = 0; $i < @t; $i++) {
    my $x = $t[$i];
    $round++ if $x eq '(';
    $round-- if $x eq ')';
    if ($x eq '{' && !$round) {
      if (@statement && ($statement[0] eq 'namespace' || (@statement > 1 && $statement[0] eq 'inline' && $statement[1] eq 'namespace'))) {
        push @spaces, join '', grep { $_ ne 'namespace' && $_ ne 'inline' } @statement;
        @statement = ();
        next;
      }
      my ($depth, @enumerators) = (0);
      for (; $i < @t; $i++) {
        $depth++ if $t[$i] eq '{';
        $depth-- if $t[$i] eq '}';
        push @enumerators, $t[$i] if $depth == 1 && $t[$i] =~ /^[A-Za-z_]/ && $t[$i - 1] =~ /^[{,]$/;
        last if $depth == 0;
      }
      my $head = join ' ', @statement;
      my $type = $head =~ /^(?:template <.*> )?(?:struct|class|union|enum)\b/;
      push @statement, '{}';
      push @statement, @enumerators if $head =~ /^enum\b/ && $head !~ /^enum (?:class|struct)\b/;
      # A function ends with its body; a type or a variable goes on to its semicolon.
      (my $outside = $head) =~ s/operator (?:[^\w\s(] ?)+//;
      1 while $outside =~ s/\([^()]*\)//;
      $declare->() if !$type && $head =~ /\(/ && $outside !~ /=/;
      next;
    }
    if ($x eq '}' && !$round) { pop @spaces; @statement = (); next }
    if ($x eq ';' && !$round) { $declare->(); next }
    push @statement, $x;
  }
  my %mentions;
  for my $i (0 .. $#t) {
    next unless $t[$i] =~ /^[A-Za-z_]/;
    next if $i > 0 && $t[$i - 1] =~ /^(?:\.|->|::)$/;
    $mentions{ $t[$i] } = 1;
  }
  $private{$_}{''} = 'macro' for @{ $file->{macros} };
  return { %$file, private => \%private, open => \%open, mentions => \%mentions, spaces => [keys %in] };
}

my (%scanned, %closure_of);
sub scanned { my ($path) = @_; return $scanned{$path} //= scan($path) }

sub resolved {
  my ($from, $name) = @_;
  (my $folder = $from) =~ s{/[^/]*$}{};
  for my $candidate ("$folder/$name", "$lib/$name", "$tree/$name", "$root/$name") { return $candidate if -e $candidate }
  return ();
}

# All project headers that a file brings along.
sub closure {
  my ($path) = @_;
  return $closure_of{$path} if $closure_of{$path};
  my (%seen, @todo);
  push @todo, map { resolved($path, $_) } @{ scanned($path)->{includes} };
  while (@todo) {
    my $header = pop @todo;
    next if $seen{$header}++;
    push @todo, map { resolved($header, $_) } @{ scanned($header)->{includes} };
  }
  return $closure_of{$path} = \%seen;
}

# One namespace is seen from the other: the same, or one inside the other.
sub related { my ($a, $b) = @_; return index("$a\::", "$b\::") == 0 || index("$b\::", "$a\::") == 0 || $a eq '' || $b eq '' }
sub sees { my ($spaces, $where) = @_; return grep { related($_, $where) } @$spaces }

# What only this source may know: anonymous names, and open ones that no header of its own declares.
my %own_of;
sub own {
  my ($path) = @_;
  return $own_of{$path} if $own_of{$path};
  my $file = scanned($path);
  my %own = %{ $file->{private} };
  my %announced;
  for my $header (keys %{ closure($path) }) { $announced{$_} = 1 for keys %{ scanned($header)->{open} } }
  for my $name (keys %{ $file->{open} }) {
    $own{$name} = { %{ $own{$name} // {} }, %{ $file->{open}{$name} } } unless $announced{$name};
  }
  return $own_of{$path} = \%own;
}

# A names a whole namespace in WHERE: what B says there means something else where it mentions a name of that namespace that
# nothing nearer hides.
sub reaches {
  my ($a, $b, $where, $directive) = @_;
  (my $space = $directive) =~ s/^using namespace //;
  $space =~ s/ //g;
  my %headers = (%{ closure($a) }, %{ closure($b) });
  my (%theirs, %hidden);
  for my $open (map { scanned($_)->{open} } $a, keys %headers) {
    for my $name (keys %$open) {
      for my $in (keys %{ $open->{$name} }) {
        $theirs{$name} = 1 if $in eq $space || $in =~ /::\Q$space\E$/;
        $hidden{$name} = 1 if $in eq $where;
      }
    }
  }
  return grep { $theirs{$_} && !$hidden{$_} } keys %{ scanned($b)->{mentions} };
}

sub disturbs {
  my ($a, $b) = @_;  # private names of A, mentioned in B
  my ($own, $other) = (own($a), scanned($b));
  my $theirs = own($b);
  for my $name (keys %$own) {
    next unless $other->{mentions}{$name} || $name =~ /^using namespace /;
    for my $where (keys %{ $own->{$name} }) {
      my $how = $own->{$name}{$where};
      next if ($theirs->{$name}{$where} // '') eq $how && $how =~ /^(?:using|namespace) /;
      next unless sees($other->{spaces}, $where);
      return 1 if $name !~ /^using namespace / || reaches($a, $b, $where, $how);
    }
  }
  return 0;
}

# Private names of A, declared by a header that B brings along and A does not know.
sub surprises {
  my ($a, $b) = @_;
  my ($own, $known) = (own($a), closure($a));
  for my $header (keys %{ closure($b) }) {
    next if $known->{$header};
    my $open = scanned($header)->{open};
    for my $name (keys %$own) {
      next unless $open->{$name};
      return 1 if grep { my $where = $_; grep { related($_, $where) } keys %{ $own->{$name} } } keys %{ $open->{$name} };
    }
  }
  return 0;
}

my %together;
sub together {
  my ($a, $b) = @_;
  return $together{"$a $b"} //= !(disturbs($a, $b) || disturbs($b, $a) || surprises($a, $b) || surprises($b, $a));
}

# Seconds of processor time that a unit takes to compile, fitted to the units of one day (GCC 12, -O2): for progress and
# estimates alone.
sub seconds {
  my (@sources) = @_;
  my $heavy = grep { my $s = $_; scanned($s)->{heavy} || grep { scanned($_)->{heavy} } keys %{ closure($s) } } @sources;
  my $lines = 0;
  $lines += scanned($_)->{lines} for @sources;
  return sprintf '%.1f', 0.9 + 0.0022 * $lines + ($heavy ? 1.2 + 0.9 * $heavy : 0);
}

sub write_unit {
  my ($path, @sources) = @_;
  my (%seen, @headers);
  for my $source (@sources) {
    for my $name (@{ scanned($source)->{includes} }) {
      my ($header) = resolved($source, $name);
      push @headers, $header if defined $header && !$seen{$header}++;
    }
  }
  # By names below the include folders, so that the text, and what a compiler cache makes of it, is the same in any checkout.
  my $text = "// Written by cmake/units.pl; do not edit.\n";
  for my $file (@headers, @sources) {
    (my $name = $file) =~ s{^(?:\Q$lib\E|\Q$tree\E|\Q$root\E)/}{};
    $text .= "#include \"$name\"\n";
  }
  if (open my $old, '<', $path) { local $/; return if <$old> eq $text }
  open my $new, '>', $path or die "units.pl: $path: $!\n";
  print $new $text;
  close $new or die "units.pl: $path: $!\n";
}

my $costs = '';
while (my $group = <STDIN>) {
  my ($name, @sources) = split ' ', $group;
  my @units;
  for my $source (@sources) {
    my $lines = scanned($source)->{lines};
    my $alone = scanned($source)->{alone};
    my ($unit) = grep {
      my $u = $_;
      !$alone && !$u->{alone} &&
      $u->{lines} + $lines <= $lines_wanted && !grep { !together($_, $source) } @{ $u->{sources} }
    } @units;
    push @units, $unit = { lines => 0, sources => [], alone => $alone } unless $unit;
    $unit->{lines} += $lines;
    push @{ $unit->{sources} }, $source;
  }
  system 'mkdir', '-p', "$out/$name";
  my $n = 0;
  my @paths = map {
    my $path = sprintf '%s/%s/unit_%02d.cpp', $out, $name, $n++;
    write_unit($path, @{ $_->{sources} });
    (my $step = $path) =~ s{^.*?/(units/)}{$1};
    $costs .= $step . ' ' . seconds(@{ $_->{sources} }) . "\n";
    $path
  } @units;
  print "$name;", join(';', @paths), "\n";
}
open my $file, '>', "$out.costs" or die "units.pl: $out.costs: $!\n";
print $file $costs;
close $file or die "units.pl: $out.costs: $!\n";
