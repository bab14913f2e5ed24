(* Theorem 3: two shields never both claim, by arrival or by turns. What a shield counts, and how it takes and drops turns, is
   transcribed from precedence.rs and waiting.rs. *)
Require Import Reals Lra Lia Psatz Arith.
Require Import Contract Shipped Motion Reach Statement Ego Precedence.

(* Two vehicles, named by a bool, and two shields that watch both. *)
Section Turns.
Variables (k : contract) (v : bool -> R -> R) (arrival : bool -> R) (from r : R).
Hypothesis ok : valid k.
Hypothesis keeps : forall x, keeps_contract k (v x) from.
(* m calls of motion end a count; T is the patience, G the grace. *)
Variables (m T G : nat).
Hypothesis en : enough k m.
Hypothesis patient : (5 <= T)%nat.
Hypothesis graceful : (m + 2 <= G)%nat.
Hypothesis jitter_small : (jitter k <= period k / 8)%R.

(* Turn n begins after so many periods. *)
Definition begins (n : nat) := (2 ^ n * T)%nat.

(* What a shield counts for the pair, on its grid g: S calls in a row that are sure of the rest of both after their arrival;
   L calls since one of both has not arrived, or has moved; None if that is not known. *)
Record counts (g : nat -> R) (sure ended : nat -> Prop) (S_ : nat -> nat) (L : nat -> option nat) : Prop := {
  grid_of : on_grid k g;
  begun : (from <= g 0%nat)%R;
  sure_of : forall i, sure i -> forall x, (v x (g i) <= r)%R /\ (arrival x <= g i)%R;
  ended_by : forall i, ended i -> exists x, (g i < arrival x)%R \/
    ((m - 1 <= i)%nat /\ forall j, (i - (m - 1) <= j <= i)%nat -> (r + dip k < v x (g j))%R);
  S_counts : forall i, (S_ i <= i + 1)%nat /\ forall j, (j <= i)%nat -> (i < j + S_ i)%nat -> sure j;
  L_counts : forall i l, L i = Some l ->
    (l <= i)%nat /\ ended (i - l)%nat /\ forall j, (i - l <= j <= i)%nat -> L j = Some (j - (i - l))%nat
}.

(* How a shield takes and drops turns. [owns i n]: by its order at call i turn n is its own. *)
Record takes_turns (S_ : nat -> nat) (L : nat -> option nat) (owns : nat -> nat -> Prop) (turn : nat -> option nat) : Prop := {
  takes : forall i n, turn i = Some n ->
    (1 <= i /\ turn (i - 1) = Some n)%nat \/
    (S_ i = begins n + G /\ owns i n /\ exists l, L i = Some l /\ begins n <= l < begins (n + 1))%nat;
  drops_unknown : forall i, L i = None -> turn i = None;
  drops_at : forall i n, L i = Some (begins n) -> turn i = None;
  drops_late : forall i x n, L i = Some (x * T)%nat -> (begins n <= x * T)%nat -> (S_ i < begins n)%nat -> turn i = None
}.

(* Lemma 6: two shields do not both own a turn within one stretch of rest, as the second one counts it. *)
Definition agree (p q : nat -> R) (L_q : nat -> option nat) (owns_p owns_q : nat -> nat -> Prop) :=
  forall i j n l, (p i <= q j)%R -> L_q j = Some l -> (q (j - l)%nat <= p i)%R -> owns_p i n -> ~ owns_q j n.

(* Where one of both has the right of way, they agree: it settles whose turn it is. *)
Lemma right_of_way_agrees p q L_q (gives_way : bool) :
  agree p q L_q (fun _ n => Nat.even (n / 2) = gives_way) (fun _ n => Nat.even (n / 2) = negb gives_way).
Proof. intros i j n l _ _ _ a b. rewrite a in b. destruct gives_way; discriminate. Qed.

Lemma begins_grows n n' : (n <= n' -> begins n <= begins n')%nat.
Proof. intros h. unfold begins. apply Nat.mul_le_mono_r, Nat.pow_le_mono_r; lia. Qed.

Lemma begins_least n : (T <= begins n)%nat.
Proof. replace T with (begins 0) by (unfold begins; simpl; lia). apply begins_grows. lia. Qed.

(* Every turn that is held was taken at some call. *)
Lemma taken S_ L owns turn i n : takes_turns S_ L owns turn -> turn i = Some n ->
  exists i0, (i0 <= i)%nat /\ (forall j, (i0 <= j <= i)%nat -> turn j = Some n) /\
    (S_ i0 = begins n + G)%nat /\ owns i0 n /\ exists l, L i0 = Some l /\ (begins n <= l < begins (n + 1))%nat.
Proof.
  intros rules. induction i as [| i IH]; intros has.
  - destruct (takes _ _ _ _ rules 0%nat n has) as [[? _] | [a b]]; [lia |].
    exists 0%nat. split; [lia |]. split; [| auto]. intros j hj. replace j with 0%nat by lia. exact has.
  - destruct (takes _ _ _ _ rules (S i) n has) as [[_ before] | [a b]].
    + replace (S i - 1)%nat with i in before by lia. destruct (IH before) as (i0 & le & held & rest).
      exists i0. split; [lia |]. split; [| exact rest]. intros j hj.
      destruct (Nat.eq_dec j (S i)) as [-> | ne]; [exact has | apply held; lia].
    + exists (S i). split; [lia |]. split; [| auto]. intros j hj. replace j with (S i) by lia. exact has.
Qed.

(* The last call up to a time. *)
Lemma last_call g i0 i y : (i0 <= i)%nat -> (g i0 <= y < g (i + 1)%nat)%R ->
  exists i1, (i0 <= i1 <= i)%nat /\ (g i1 <= y < g (i1 + 1)%nat)%R.
Proof.
  intros le [lo hi]. induction i as [| i IH].
  - exists 0%nat. replace i0 with 0%nat in lo by lia. split; [lia | lra].
  - destruct (Rle_dec (g (S i)) y) as [now | later]; [exists (S i); split; [lia | lra] |].
    destruct (Nat.eq_dec i0 (S i)) as [-> | ne]; [exfalso; lra |].
    destruct IH as (i1 & ? & ?); [lia | replace (i + 1)%nat with (S i) by lia; lra |]. exists i1. split; [lia | lra].
Qed.

Section Two.
Variables (p q : nat -> R) (sure_p ended_p sure_q ended_q : nat -> Prop) (S_p S_q : nat -> nat) (L_p L_q : nat -> option nat).
Hypothesis P : counts p sure_p ended_p S_p L_p.
Hypothesis Q : counts q sure_q ended_q S_q L_q.

Open Scope R_scope.

Lemma calls_strictly g i j : on_grid k g -> g i <= g j -> (i <= j)%nat.
Proof.
  intros grid le. destruct (le_lt_dec i j) as [? | lt]; [assumption | exfalso].
  pose proof (spacing k g grid j (i - j)) as [A _]. replace (j + (i - j))%nat with i in A by lia.
  assert (1 <= INR (i - j)) by (change 1 with (INR 1); apply le_INR; lia).
  assert (p0 : 0 < period k) by (destruct ok; lra).
  assert (1 * period k <= INR (i - j) * period k) by (apply Rmult_le_compat_r; lra). lra.
Qed.

(* Lemma 5 for the pair. *)
Lemma pair_surely_at_most_perhaps i j l : L_p i = Some l -> p i <= q j < p (i + 1)%nat -> (S_q j <= l + (m - 1))%nat.
Proof.
  intros known now. destruct (L_counts _ _ _ _ _ P i l known) as (li & end_ & _).
  destruct (ended_by _ _ _ _ _ P _ end_) as (x & why).
  destruct (S_counts _ _ _ _ _ Q j) as [short stretch].
  apply (surely_at_most_perhaps k (v x) from r ok (keeps x) p q (grid_of _ _ _ _ _ P) (grid_of _ _ _ _ _ Q) (arrival x)
           (q j) m (j + 1 - S_q j) (S_q j) sure_q (i - l) l en (begun _ _ _ _ _ P)).
  - split; [intros j' s; apply (sure_of _ _ _ _ _ Q j' s x) |].
    split; [intros j' hj; apply stretch; lia |].
    split; [intros j' le; pose proof (calls_strictly q j' j (grid_of _ _ _ _ _ Q) le); lia |].
    intros nz. replace (j + 1 - S_q j + S_q j - 1)%nat with j by lia. lra.
  - split; [exact why |]. replace (i - l + l)%nat with i by lia. exact now.
Qed.
End Two.

(* P holds turn n when Q has rested for so long that it will take turn n' in G - G' calls. *)
Lemma no_turn_before p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p turn_p i0 i1 j0 n n' lQ G' :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q ->
  takes_turns S_p L_p owns_p turn_p -> (m - 1 <= G')%nat ->
  (i0 <= i1)%nat -> (forall i, (i0 <= i <= i1)%nat -> turn_p i = Some n) ->
  S_p i0 = (begins n + G)%nat -> owns_p i0 n -> (exists l, L_p i0 = Some l /\ (begins n <= l < begins (n + 1))%nat) ->
  (begins n' + G' <= S_q j0)%nat -> L_q j0 = Some lQ -> (begins n' <= lQ < begins (n' + 1))%nat ->
  ((q (j0 - lQ)%nat <= p i0)%R -> ~ owns_p i0 n') ->
  (p i0 <= q j0)%R -> (p i1 <= q j0 < p (i1 + 1)%nat)%R -> False.
Proof.
  intros P Q rules grace le held sP oP (l0 & L0 & l0a & l0b) sQ LQ [lQa lQb] order first now.
  pose proof (grid_of _ _ _ _ _ P) as gp. pose proof (grid_of _ _ _ _ _ Q) as gq.
  assert (p0 : (0 < period k)%R) by (destruct ok; lra).
  assert (j00 : (0 <= jitter k)%R) by (destruct ok; lra).
  assert (m3 : (m = 2 \/ m = 3)%nat) by (destruct en as [[-> _] | [-> _]]; auto).
  (* P's count has passed the beginning of Q's turn, and P dropped there what it had. *)
  destruct (L_p i1) as [l1 |] eqn:L1; [| pose proof (held i1 ltac:(lia)) as has; rewrite (drops_unknown _ _ _ _ rules i1 L1) in has; discriminate].
  pose proof (pair_surely_at_most_perhaps p q _ _ _ _ _ _ _ _ P Q i1 j0 l1 L1 now) as five.
  destruct (L_counts _ _ _ _ _ P i1 l1 L1) as (l1i & _ & counted).
  set (base := (i1 - l1)%nat) in *.
  assert (after_ : (base + begins n' < i0)%nat).
  { destruct (le_lt_dec i0 (base + begins n')) as [early | ?]; [exfalso | assumption].
    pose proof (counted (base + begins n')%nat ltac:(lia)) as C. replace (base + begins n' - base)%nat with (begins n') in C by lia.
    pose proof (held (base + begins n')%nat ltac:(lia)) as has. rewrite (drops_at _ _ _ _ rules _ _ C) in has. discriminate. }
  pose proof (counted i0 ltac:(lia)) as C0. rewrite L0 in C0. injection C0 as C0.
  assert (nn : (n' <= n)%nat).
  { destruct (le_lt_dec n' n) as [? | lt]; [assumption | exfalso].
    pose proof (begins_grows (n + 1) n' ltac:(lia)). lia. }
  (* Q's count ended after P took its turn. *)
  destruct (L_counts _ _ _ _ _ Q j0 lQ LQ) as (lQj & end_ & countedQ).
  set (e := (j0 - lQ)%nat) in *.
  assert (late : (p i0 < q e)%R).
  { destruct (Rlt_le_dec (p i0) (q e)) as [? | early]; [assumption | exfalso].
    destruct (Nat.eq_dec n n') as [-> | ne]; [exact (order early oP) |].
    pose proof (begins_grows (n' + 1) n ltac:(lia)) as later.
    assert (q j0 < q (j0 + 1)%nat)%R.
    { pose proof (spacing k q gq j0 1) as [A _]. simpl INR in A. lra. }
    destruct (last_call q e j0 (p i0)) as (j1 & hj1 & now1); [unfold e; lia | lra |].
    pose proof (countedQ j1 ltac:(lia)) as C1.
    pose proof (pair_surely_at_most_perhaps q p _ _ _ _ _ _ _ _ Q P j1 i0 (j1 - e) C1 now1) as five'. rewrite sP in five'.
    unfold e in *. lia. }
  destruct (S_counts _ _ _ _ _ P i0) as [shortP stretchP].
  assert (sure0 : sure_p i0) by (apply stretchP; lia).
  destruct (ended_by _ _ _ _ _ Q e end_) as (x & [absent | [back fast]]).
  { destruct (sure_of _ _ _ _ _ P i0 sure0 x). lra. }
  (* So P has seen it, too, after it took its turn. *)
  set (e' := (e - (m - 1))%nat) in *. assert (ee : (e' + (m - 1) = e)%nat) by (unfold e'; lia).
  pose proof (spacing k q gq e' (m - 1)) as [_ back_]. rewrite ee in back_.
  assert (INR (m - 1) <= 2)%R.
  { destruct m3 as [-> | ->]; simpl; lra. }
  assert (INR (m - 1) * period k <= 2 * period k)%R by (apply Rmult_le_compat_r; lra).
  assert (long : (7 <= S_p i0)%nat) by (pose proof (begins_least n); lia).
  assert (started : (p 0%nat <= q e')%R).
  { pose proof (spacing k p gp 0 i0) as [A _]. simpl plus in A.
    assert (6 <= INR i0)%R by (change 6%R with (IZR (Z.of_nat 6)); rewrite <- INR_IZR_INZ; apply le_INR; lia).
    assert (6 * period k <= INR i0 * period k)%R by (apply Rmult_le_compat_r; lra). lra. }
  destruct (seen_to_move k (v x) from r ok (keeps x) q p gq gp e' m en) as (rho & between & moving).
  { apply Rle_trans with (q 0%nat); [apply (begun _ _ _ _ _ Q) | apply (calls_ordered k q ok gq); lia]. }
  { exact started. }
  { intros j hj. apply fast. unfold e' in *. lia. }
  rewrite ee in between.
  assert (unsure : ~ sure_p rho) by (intros s; destruct (sure_of _ _ _ _ _ P rho s x); lra).
  assert (r1 : (i0 < rho)%nat).
  { destruct (le_lt_dec rho i0) as [early | ?]; [exfalso | assumption].
    destruct (le_lt_dec (rho + S_p i0) i0) as [before | within]; [| apply unsure, stretchP; lia].
    pose proof (spacing k p gp rho (i0 - rho)) as [A _]. replace (rho + (i0 - rho))%nat with i0 in A by lia.
    assert (7 <= INR (i0 - rho))%R by (change 7%R with (IZR (Z.of_nat 7)); rewrite <- INR_IZR_INZ; apply le_INR; lia).
    assert (7 * period k <= INR (i0 - rho) * period k)%R by (apply Rmult_le_compat_r; lra). lra. }
  assert (qe : (q e <= q j0)%R) by (apply (calls_ordered k q ok gq); unfold e; lia).
  (* Q has counted a whole patience since then, so P has, nearly. *)
  assert (unsureQ : ~ sure_q e).
  { intros s. destruct (sure_of _ _ _ _ _ Q e s x) as [slow _]. pose proof (fast e ltac:(lia)).
    assert (0 <= dip k)%R; [| lra]. unfold dip. destruct ok.
    apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [nra | left; apply Rinv_0_lt_compat; lra]. }
  destruct (S_counts _ _ _ _ _ Q j0) as [_ stretchQ].
  assert (countQ : (S_q j0 <= lQ)%nat).
  { destruct (le_lt_dec (S_q j0) lQ) as [? | more]; [assumption | exfalso]. apply unsureQ, stretchQ; unfold e; lia. }
  pose proof (begins_least n') as least_.
  assert (far : (rho + T <= i1)%nat).
  { pose proof (spacing k q gq e (j0 - e)) as [A _]. replace (e + (j0 - e))%nat with j0 in A by (unfold e; lia).
    destruct (le_lt_dec (rho + T) i1) as [? | near]; [assumption | exfalso].
    pose proof (spacing k p gp rho (i1 + 1 - rho)) as [_ U].
    assert (ri : (rho <= i1 + 1)%nat) by (apply (calls_strictly p rho (i1 + 1) gp); lra).
    replace (rho + (i1 + 1 - rho))%nat with (i1 + 1)%nat in U by lia.
    assert (INR (i1 + 1 - rho) + 1 <= INR (j0 - e))%R.
    { rewrite <- S_INR. apply le_INR. unfold e. lia. }
    assert ((INR (i1 + 1 - rho) + 1) * period k <= INR (j0 - e) * period k)%R by (apply Rmult_le_compat_r; lra). lra. }
  (* Within a patience P's count was a multiple of it, and P dropped its turn. *)
  set (c := (rho + T - base)%nat).
  set (y := (c / T)%nat).
  pose proof (Nat.div_mod c T ltac:(lia)) as D. fold y in D.
  pose proof (Nat.mod_upper_bound c T ltac:(lia)) as M.
  set (j := (base + y * T)%nat).
  assert (hj : (rho < j <= rho + T)%nat) by (unfold j, c in *; lia).
  pose proof (counted j ltac:(lia)) as Cj. replace (j - base)%nat with (y * T)%nat in Cj by (unfold j; lia).
  destruct (S_counts _ _ _ _ _ P j) as [_ stretchJ].
  assert (Sj : (S_p j <= T)%nat).
  { destruct (le_lt_dec (S_p j) T) as [? | more]; [assumption | exfalso]. apply unsure, stretchJ; lia. }
  assert (two : (begins 1 <= y * T)%nat).
  { change (begins 1) with (2 * T)%nat. apply Nat.mul_le_mono_r.
    destruct (le_lt_dec 2 y) as [? | small]; [assumption | exfalso].
    assert (y * T <= 1 * T)%nat by (apply Nat.mul_le_mono_r; lia). unfold j in hj. lia. }
  pose proof (held j ltac:(lia)) as has.
  rewrite (drops_late _ _ _ _ rules j y 1%nat Cj two) in has; [discriminate |].
  change (begins 1) with (2 * T)%nat. lia.
Qed.

(* Two turns: P holds turn n when Q takes turn n'. *)
Lemma no_second_turn p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_p i0 i1 j0 n n' :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q ->
  takes_turns S_p L_p owns_p turn_p ->
  agree p q L_q owns_p owns_q ->
  (i0 <= i1)%nat -> (forall i, (i0 <= i <= i1)%nat -> turn_p i = Some n) ->
  S_p i0 = (begins n + G)%nat -> owns_p i0 n -> (exists l, L_p i0 = Some l /\ (begins n <= l < begins (n + 1))%nat) ->
  S_q j0 = (begins n' + G)%nat -> owns_q j0 n' -> (exists l, L_q j0 = Some l /\ (begins n' <= l < begins (n' + 1))%nat) ->
  (p i0 <= q j0)%R -> (p i1 <= q j0 < p (i1 + 1)%nat)%R -> False.
Proof.
  intros P Q rules order le held sP oP lP sQ oQ (lQ & LQ & between) first now.
  apply (no_turn_before p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p turn_p i0 i1 j0 n n' lQ G); auto; [lia | lia |].
  intros early own. exact (order i0 j0 n' lQ first LQ early own oQ).
Qed.

(* Never two turns at one time. *)
Theorem never_two_turns p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_p turn_q i j n n' x :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q ->
  takes_turns S_p L_p owns_p turn_p -> takes_turns S_q L_q owns_q turn_q ->
  agree p q L_q owns_p owns_q -> agree q p L_p owns_q owns_p ->
  (p i <= x < p (i + 1)%nat)%R -> (q j <= x < q (j + 1)%nat)%R ->
  turn_p i = Some n -> turn_q j <> Some n'.
Proof.
  intros P Q rp rq order order' now_p now_q tp tq.
  destruct (taken S_p L_p owns_p turn_p i n rp tp) as (i0 & lei & held_p & sp & op & lp).
  destruct (taken S_q L_q owns_q turn_q j n' rq tq) as (j0 & lej & held_q & sq & oq & lq).
  pose proof (calls_ordered k p ok (grid_of _ _ _ _ _ P) i0 i lei).
  pose proof (calls_ordered k q ok (grid_of _ _ _ _ _ Q) j0 j lej).
  destruct (Rle_dec (p i0) (q j0)) as [p_first | q_first].
  - destruct (last_call p i0 i (q j0) lei) as (i1 & h1 & now); [lra |].
    apply (no_second_turn p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_p i0 i1 j0 n n'); auto; [lia |].
    intros a ha. apply held_p. lia.
  - destruct (last_call q j0 j (p i0) lej) as (j1 & h1 & now); [lra |].
    apply (no_second_turn q p sure_q ended_q sure_p ended_p S_q S_p L_q L_p owns_q owns_p turn_q j0 j1 i0 n' n); auto;
      [lia | | lra].
    intros a ha. apply held_q. lia.
Qed.

(* A claim by arrival never comes back, and ends when L is unknown or has reached the first turn. *)
Record claims_by_arrival (L : nat -> option nat) (claim : nat -> Prop) : Prop := {
  never_back : forall i, claim (S i) -> claim i;
  not_unknown : forall i, L i = None -> ~ claim i;
  not_in_turns : forall i, L i = Some (begins 0) -> ~ claim i
}.

Lemma claimed_before L claim i j : claims_by_arrival L claim -> (i <= j)%nat -> claim j -> claim i.
Proof. intros rules le. induction le; [auto |]. intros c. apply IHle, (never_back L claim rules), c. Qed.

(* A turn and a claim by arrival. *)
Lemma no_claim_in_a_turn p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_q turn_q claim i j n x :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q ->
  takes_turns S_q L_q owns_q turn_q -> claims_by_arrival L_p claim ->
  (p i <= x < p (i + 1)%nat)%R -> (q j <= x < q (j + 1)%nat)%R -> turn_q j = Some n -> ~ claim i.
Proof.
  intros P Q rq rules now_p now_q tq cl.
  destruct (taken S_q L_q owns_q turn_q j n rq tq) as (j0 & lej & _ & sq & _ & _).
  pose proof (calls_ordered k q ok (grid_of _ _ _ _ _ Q) j0 j lej).
  assert (m3 : (m = 2 \/ m = 3)%nat) by (destruct en as [[-> _] | [-> _]]; auto).
  pose proof (begins_least n) as least_.
  destruct (Rlt_le_dec (q j0) (p 0%nat)) as [late | watched].
  - (* P began to watch after that: of those who rest it knows nothing. *)
    pose proof (claimed_before L_p claim 0 i rules ltac:(lia) cl) as c0.
    destruct (L_p 0%nat) as [l |] eqn:L0; [| exact (not_unknown _ _ rules 0%nat L0 c0)].
    destruct (L_counts _ _ _ _ _ P 0%nat l L0) as (l0 & end_ & _).
    destruct (ended_by _ _ _ _ _ P _ end_) as (y & [absent | [back _]]); [| lia].
    destruct (S_counts _ _ _ _ _ Q j0) as [_ stretch].
    destruct (sure_of _ _ _ _ _ Q j0 (stretch j0 ltac:(lia) ltac:(lia)) y) as [_ arrived].
    replace (0 - l)%nat with 0%nat in absent by lia. lra.
  - destruct (last_call p 0 i (q j0) ltac:(lia)) as (i1 & h1 & now); [lra |].
    pose proof (claimed_before L_p claim i1 i rules ltac:(lia) cl) as c1.
    destruct (L_p i1) as [l1 |] eqn:L1; [| exact (not_unknown _ _ rules i1 L1 c1)].
    pose proof (pair_surely_at_most_perhaps p q _ _ _ _ _ _ _ _ P Q i1 j0 l1 L1 now) as five. rewrite sq in five.
    destruct (L_counts _ _ _ _ _ P i1 l1 L1) as (l1i & _ & counted).
    pose proof (counted (i1 - l1 + T)%nat ltac:(lia)) as C.
    replace (i1 - l1 + T - (i1 - l1))%nat with (begins 0) in C by (unfold begins; simpl; lia).
    apply (not_in_turns _ _ rules _ C). apply (claimed_before L_p claim _ i1 rules); [lia | exact c1].
Qed.

(* Theorem 3, never both. Lemma 1 excludes that both claim by arrival. *)
Theorem never_both p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_p turn_q claim_p claim_q :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q ->
  takes_turns S_p L_p owns_p turn_p -> takes_turns S_q L_q owns_q turn_q ->
  claims_by_arrival L_p claim_p -> claims_by_arrival L_q claim_q ->
  agree p q L_q owns_p owns_q -> agree q p L_p owns_q owns_p -> (forall i j, claim_p i -> ~ claim_q j) ->
  forall x i j, (p i <= x < p (i + 1)%nat)%R -> (q j <= x < q (j + 1)%nat)%R ->
  claim_p i \/ turn_p i <> None -> ~ (claim_q j \/ turn_q j <> None).
Proof.
  intros P Q rp rq cp cq order order' arrivals x i j now_p now_q [a | a] [b | b].
  - exact (arrivals i j a b).
  - destruct (turn_q j) as [n |] eqn:e; [| congruence].
    exact (no_claim_in_a_turn p q _ _ _ _ _ _ _ _ _ _ _ i j n x P Q rq cp now_p now_q e a).
  - destruct (turn_p i) as [n |] eqn:e; [| congruence].
    exact (no_claim_in_a_turn q p _ _ _ _ _ _ _ _ _ _ _ j i n x Q P rp cq now_q now_p e b).
  - destruct (turn_p i) as [n |] eqn:e; [| congruence]. destruct (turn_q j) as [n' |] eqn:e'; [| congruence].
    exact (never_two_turns p q _ _ _ _ _ _ _ _ _ _ _ _ i j n n' x P Q rp rq order order' now_p now_q e e').
Qed.
End Turns.
